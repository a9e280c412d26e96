#include "datasets/contact_files.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "datasets/file_bytes.h"
#include "datasets/id_columns.h"
#include "datasets/lammps_dump.h"

namespace touchstone {
namespace {

static_assert(std::endian::native == std::endian::little, "binary lists are read as they lie");

constexpr std::pair<ContactFormat, std::string_view> kFormats[] = {
    {ContactFormat::automatic, "auto"},  {ContactFormat::csv, "csv"},       {ContactFormat::pairs32, "pairs32"},
    {ContactFormat::pairs64, "pairs64"}, {ContactFormat::lammps, "lammps"}, {ContactFormat::yade, "yade"}};

// Collects entries as their ids are turned into indices. `where` tells the place of the entry at hand, for errors.
class Entries {
 public:
  Entries(ContactFile& file, const ContactFileOptions& options, const BallNumbering& numbering)
      : file_(file), skip_others_(options.skip_others), numbering_(numbering), usual_first_(usual_first_id(file.format)) {}

  template <class Fail>
  void add(std::int64_t a, std::int64_t b, const Fail& fail) {
    const std::int32_t i = numbering_.index_of(a, usual_first_), j = numbering_.index_of(b, usual_first_);
    if (i >= 0 && j >= 0)
      file_.entries.push_back({i, j});
    else if (skip_others_)
      ++file_.others;
    else
      fail(refusal(i < 0 ? a : b));
  }

 private:
  std::string refusal(std::int64_t id) const {
    if (!numbering_.first && !numbering_.id.empty())
      return fmt::format("id {} is no ball of the packing, whose ids run from {} to {} (walls: --skip-others)", id,
                         numbering_.id.front(), numbering_.id.back());
    const std::int64_t first = numbering_.first.value_or(usual_first_);
    return fmt::format("id {} is no ball of the packing, which has {} to {} (another first id: --base; walls: --skip-others)", id,
                       first, first + numbering_.n - 1);
  }

  ContactFile& file_;
  bool skip_others_;
  const BallNumbering& numbering_;
  std::int64_t usual_first_;
};

// The layout of a text table, settled by its first line with names or data.
class TableLayout {
 public:
  TableLayout(const std::vector<std::string>& asked, ContactFile& file) : asked_(asked), file_(file) {}
  bool known() const { return expected_ > 0; }
  std::size_t expected() const { return expected_; }
  const TwoColumns& at() const { return at_; }

  // A comment above the data may name the columns; any other is prose.
  void see_comment(const Columns& words, const TextLines& lines) {
    const auto found = asked_.empty() ? known_columns(words) : asked_columns(asked_, words, true);
    if (found) settle(*found, words, true, lines);
  }

  // The first line that is no comment; true if it is data, false if it is a header.
  bool see_first_line(const Columns& columns, const TextLines& lines) {
    const bool data = columns[0].find_first_of("+-.0123456789") == 0;
    std::optional<TwoColumns> found = TwoColumns{0, 1};
    if (!asked_.empty())
      found = asked_columns(asked_, data ? Columns{} : columns);
    else if (!data)
      found = known_columns(columns);
    if (!found) no_such_columns(columns, lines);
    settle(*found, columns, !data, lines);
    return data;
  }

 private:
  void settle(TwoColumns at, const Columns& columns, bool named, const TextLines& lines) {
    at_ = at;
    expected_ = columns.size();
    if (std::max(at[0], at[1]) >= expected_ || at[0] == at[1])
      lines.fail(fmt::format("{} column{}; two with ids are needed", expected_, expected_ == 1 ? "" : "s"));
    const auto name = [&](std::size_t c) { return named ? shown(unquoted(columns[c])) : std::to_string(c + 1); };
    file_.columns = fmt::format("{} and {}", name(at[0]), name(at[1]));
  }

  const std::vector<std::string>& asked_;
  ContactFile& file_;
  TwoColumns at_{};
  std::size_t expected_ = 0;
};

void read_table(std::string_view text, const std::string& where, const ContactFileOptions& options,
                const BallNumbering& numbering, ContactFile& file) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);  // byte-order mark, as spreadsheets write it
  const char separator = file.format == ContactFormat::csv ? ',' : ' ';
  TextLines lines(text, where);
  TableLayout layout(options.columns, file);
  Entries entries(file, options, numbering);
  const auto fail = [&](const std::string& cause) { lines.fail(cause); };
  std::string_view line;
  Columns columns;
  while (lines.next(line)) {
    line.remove_prefix(std::min(line.find_first_not_of(" \t"), line.size()));
    if (line.empty()) continue;
    if (line[0] == '#') {
      if (layout.known() || line.size() > kMostColumns) continue;  // longer ones might not split, and are no header
      split(line.substr(1), separator, columns, lines);
      layout.see_comment(columns, lines);
      continue;
    }
    split(line, separator, columns, lines);
    if (!layout.known() && !layout.see_first_line(columns, lines)) continue;
    if (columns.size() != layout.expected()) fail(fmt::format("{} columns, {} expected", columns.size(), layout.expected()));
    const std::int64_t a = id_of(columns[layout.at()[0]], lines), b = id_of(columns[layout.at()[1]], lines);
    entries.add(a, b, fail);
  }
}

TwoColumns dump_columns(const Columns& columns, const ContactFileOptions& options, const TextLines& lines) {
  if (!options.columns.empty()) {
    const auto asked = asked_columns(options.columns, columns);
    if (!asked || std::max((*asked)[0], (*asked)[1]) >= columns.size() || (*asked)[0] == (*asked)[1])
      no_such_columns(columns, lines);
    return *asked;
  }
  if (const auto known = known_columns(columns)) return *known;
  std::vector<std::size_t> computed;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].starts_with("c_") || columns[c].starts_with("f_")) computed.push_back(c);
  if (computed.size() < 2) no_such_columns(columns, lines);
  return {computed[0], computed[1]};
}

void read_dump(std::string_view text, const std::string& where, const ContactFileOptions& options, const BallNumbering& numbering,
               ContactFile& file) {
  TextLines lines(text, where);
  const DumpSnapshot s = open_snapshot(lines, options.timestep);
  if (s.label == "ATOMS") lines.fail("a dump of ATOMS; contacts come from `dump local`");
  const Columns names(s.columns.begin(), s.columns.end());
  const TwoColumns at = dump_columns(names, options, lines);
  file.columns = fmt::format("{} and {}", shown(names[at[0]]), shown(names[at[1]]));
  file.timestep = s.timestep;
  file.periodic = s.periodic();
  Entries entries(file, options, numbering);
  const auto fail = [&](const std::string& cause) { lines.fail(cause); };
  Columns columns;
  for (std::int64_t k = 0; k < s.count; ++k) {
    split(next_row(lines, s, k), ' ', columns, lines);
    if (columns.size() != names.size()) fail(fmt::format("{} columns, {} expected", columns.size(), names.size()));
    const std::int64_t a = id_of(columns[at[0]], lines), b = id_of(columns[at[1]], lines);
    entries.add(a, b, fail);
  }
  close_snapshot(lines, options.timestep);
}

template <class Int>
void read_binary(std::string_view bytes, const std::string& where, const ContactFileOptions& options,
                 const BallNumbering& numbering, ContactFile& file) {
  constexpr std::size_t kPair = 2 * sizeof(Int);
  if (bytes.size() % kPair != 0)
    throw InputError(fmt::format("{}: {} bytes; {} has {} bytes a pair, so the last pair is cut off", where, bytes.size(),
                                 to_string(file.format), kPair));
  const std::size_t count = bytes.size() / kPair;
  Entries entries(file, options, numbering);
  file.entries.reserve(count);
  for (std::size_t k = 0; k < count; ++k) {
    Int pair[2];
    std::memcpy(pair, bytes.data() + k * kPair, kPair);
    entries.add(pair[0], pair[1],
                [&](const std::string& cause) { throw InputError(fmt::format("{}: pair {}: {}", where, k + 1, cause)); });
  }
}

ContactFormat told_by(std::string_view text, const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  if (extension == ".pairs32") return ContactFormat::pairs32;
  if (extension == ".pairs64") return ContactFormat::pairs64;
  const std::string_view begin = text.substr(0, 4096);
  if (begin.find('\0') != begin.npos)
    throw InputError(fmt::format("{}: binary; say which with --format pairs32 or --format pairs64", path.string()));
  if (begin.starts_with("ITEM:")) return ContactFormat::lammps;
  // The first line with data decides between commas and blanks.
  TextLines lines(text, path.string());
  std::string_view line;
  while (lines.next(line))
    if (!line.empty() && line[0] != '#') return line.find(',') != line.npos ? ContactFormat::csv : ContactFormat::yade;
  return ContactFormat::csv;
}

}  // namespace

std::string_view to_string(ContactFormat format) {
  for (const auto& [known, word] : kFormats)
    if (known == format) return word;
  return "";
}

ContactFormat contact_format(std::string_view word) {
  for (const auto& [known, name] : kFormats)
    if (name == word) return known;
  throw InputError(fmt::format("--format '{}': auto, csv, pairs32, pairs64, lammps or yade", shown(word)));
}

std::int64_t usual_first_id(ContactFormat format) { return format == ContactFormat::lammps ? 1 : 0; }

std::int32_t BallNumbering::index_of(std::int64_t name, std::int64_t usual_first) const {
  if (!first && !id.empty()) {
    const auto at = std::lower_bound(id.begin(), id.end(), name);
    return at != id.end() && *at == name ? static_cast<std::int32_t>(at - id.begin()) : -1;
  }
  const std::int64_t from = first.value_or(usual_first);
  return name >= from && name - from < n ? static_cast<std::int32_t>(name - from) : -1;
}

ContactFile read_contacts(const std::filesystem::path& path, const ContactFileOptions& options, const BallNumbering& numbering) {
  if (!options.columns.empty() && options.columns.size() != 2)
    throw InputError("--columns: two columns, as in --columns id1,id2");
  const FileBytes bytes(path);
  const std::string where = path.string();
  ContactFile file;
  file.format = options.format == ContactFormat::automatic ? told_by(bytes.text(), path) : options.format;
  switch (file.format) {
    case ContactFormat::pairs32:
      read_binary<std::int32_t>(bytes.text(), where, options, numbering, file);
      break;
    case ContactFormat::pairs64:
      read_binary<std::int64_t>(bytes.text(), where, options, numbering, file);
      break;
    case ContactFormat::lammps:
      read_dump(bytes.text(), where, options, numbering, file);
      break;
    default:
      read_table(bytes.text(), where, options, numbering, file);
  }
  return file;
}

}  // namespace touchstone
