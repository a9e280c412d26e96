#include "bench/journal.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {

Journal::Journal(std::filesystem::path path) : path_(std::move(path)) {
  std::size_t good = 0;  // bytes of whole, readable lines
  if (std::filesystem::exists(path_)) {
    const std::string text = read_whole(path_);
    for (std::size_t begin = 0, number = 1; begin < text.size(); ++number) {
      const std::size_t end = text.find('\n', begin);
      const bool last = end == std::string::npos || end + 1 == text.size();
      Json line = Json::parse(text.substr(begin, end == std::string::npos ? end : end - begin), nullptr, false);
      if (end == std::string::npos || line.is_discarded() || !line.contains("key") || !line["key"].is_string()) {
        if (!last)
          throw InputError(fmt::format("{}:{}: not a journal line; move the file away to start anew", path_.string(), number));
        fmt::print(stderr, "{}:{}: torn last line dropped; its case is measured again\n", path_.string(), number);
        break;
      }
      std::string key = line["key"];
      order_.push_back(key);
      lines_[std::move(key)] = std::move(line);
      begin = good = end + 1;
    }
  }
  file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0 || ::ftruncate(file_, static_cast<off_t>(good)) != 0)
    throw InputError(fmt::format("{}: cannot be opened for writing: {}", path_.string(), std::strerror(errno)));
}

Journal::~Journal() {
  if (file_ >= 0) ::close(file_);
}

const Json* Journal::find(const std::string& key) const {
  const auto at = lines_.find(key);
  return at == lines_.end() ? nullptr : &at->second;
}

void Journal::append(const std::string& key, Json line) {
  line["key"] = key;
  const std::string text = line.dump() + "\n";
  for (std::size_t written = 0; written < text.size();) {
    const ssize_t n = ::write(file_, text.data() + written, text.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
    written += static_cast<std::size_t>(n);
  }
  if (::fsync(file_) != 0)
    throw std::runtime_error(fmt::format("{}: cannot be flushed: {}", path_.string(), std::strerror(errno)));
  order_.push_back(key);
  lines_[key] = std::move(line);
}

std::map<std::string, Json> Journal::cases_with_prefix(const std::string& prefix) const {
  std::map<std::string, Json> cases;
  for (const std::string& key : order_) {
    const Json& line = lines_.at(key);
    if (key.starts_with(prefix) && line.contains("entries")) cases[line["name"]] = line["entries"];
  }
  return cases;
}

}  // namespace touchstone
