#include "bench/strict_json.h"

#include <fmt/format.h>

#include <iterator>
#include <vector>

#include "datasets/file_bytes.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using nlohmann::json;

// Characters of the text, counting how many were read: the library tells its own errors' places, not those of callbacks.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, const char** furthest) : at_(at), furthest_(furthest) {}
  reference operator*() const { return *at_; }
  CountingIterator& operator++() {
    *furthest_ = ++at_;
    return *this;
  }
  CountingIterator operator++(int) {
    CountingIterator before = *this;
    ++*this;
    return before;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  const char** furthest_;
};

// Builds the document, refusing what must not be taken in silence. Names are the library's (nlohmann::json_sax).
class StrictBuilder {
 public:
  StrictBuilder(std::string_view text, const std::string& where, const JsonLimits& limits)
      : begin_(text.data()), furthest_(text.data()), where_(where), limits_(limits) {}

  const char** furthest() { return &furthest_; }
  json take() { return std::move(root_); }

  bool null() { return put(nullptr); }
  bool boolean(bool value) { return put(value); }
  bool number_integer(json::number_integer_t value) { return put(value); }
  bool number_unsigned(json::number_unsigned_t value) { return put(value); }
  bool string(std::string& value) { return put(std::move(value)); }
  bool binary(json::binary_t&) { return true; }  // never in text
  bool number_float(double value, const std::string& digits) {
    if (digits.find_first_of(".eE") == digits.npos) fail(fmt::format("{} is an integer beyond 64 bits", digits));
    return put(value);
  }
  bool start_object(std::size_t) { return open(json::object()); }
  bool start_array(std::size_t) { return open(json::array()); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }
  bool key(std::string& name) {
    const auto [at, is_new] = open_.back()->get_ref<json::object_t&>().emplace(name, nullptr);
    if (!is_new) fail(fmt::format("key \"{}\" for the second time in its object", name.substr(0, 60)));
    value_ = &at->second;
    return true;
  }
  bool parse_error(std::size_t position, const std::string&, const json::exception& error) {
    std::string cause = error.what();  // "[json.exception.parse_error.101] parse error at line 1, column 5: cause"
    if (const std::size_t at = cause.find("] "); at != cause.npos) cause = cause.substr(at + 2);
    furthest_ = begin_ + position;
    fail(cause);
  }

 private:
  [[noreturn]] void fail(const std::string& cause) const {
    throw InputError(fmt::format("{}: byte {}: {}", where_, furthest_ - begin_, cause));
  }

  // The place the next value goes to: a new element, the value of the last key, or the document itself.
  json& place() {
    if (open_.empty()) return root_;
    if (open_.back()->is_array()) return open_.back()->get_ref<json::array_t&>().emplace_back();
    return *value_;
  }
  bool put(json value) {
    place() = std::move(value);
    return true;
  }
  bool open(json value) {
    if (static_cast<int>(open_.size()) >= limits_.deepest) fail(fmt::format("nested deeper than {}", limits_.deepest));
    json& at = place();
    at = std::move(value);
    open_.push_back(&at);  // stays where it is: its parent does not grow before it is closed
    return true;
  }
  bool close() {
    open_.pop_back();
    return true;
  }

  const char* begin_;
  const char* furthest_;
  const std::string& where_;
  JsonLimits limits_;
  json root_;
  std::vector<json*> open_;
  json* value_ = nullptr;
};

}  // namespace

nlohmann::json parse_strict_json(std::string_view text, const std::string& where, const JsonLimits& limits) {
  if (text.size() > limits.most_bytes)
    throw InputError(fmt::format("{}: byte {}: more than {} bytes", where, limits.most_bytes, limits.most_bytes));
  StrictBuilder builder(text, where, limits);
  json::sax_parse(CountingIterator(text.data(), builder.furthest()),
                  CountingIterator(text.data() + text.size(), builder.furthest()), &builder);
  return builder.take();
}

nlohmann::json read_strict_json(const std::filesystem::path& path, const JsonLimits& limits) {
  return parse_strict_json(FileBytes(path).text(), path.string(), limits);
}

}  // namespace touchstone
