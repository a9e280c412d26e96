#include "datasets/formats.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "datasets/file_bytes.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {

namespace {

std::vector<Ball> parse_balls(std::string_view bytes, const std::string& where) {
  if (bytes.empty()) throw InputError(fmt::format("{}: empty file", where));
  if (bytes.size() % sizeof(Ball) != 0)
    throw InputError(
        fmt::format("{}: {} bytes; a .balls file has 16 bytes a ball (x, y, z, radius as float32)", where, bytes.size()));
  std::vector<Ball> balls(bytes.size() / sizeof(Ball));
  std::memcpy(balls.data(), bytes.data(), bytes.size());
  return balls;
}

}  // namespace

PackingFormat packing_format(std::string_view word) {
  if (word.starts_with('.')) word.remove_prefix(1);
  if (word == "balls") return PackingFormat::balls;
  if (word == "xyz") return PackingFormat::xyz;
  if (word == "csv") return PackingFormat::csv;
  if (word == "vtp") return PackingFormat::vtp;
  throw InputError(fmt::format("\"{}\" is no packing format to write; known are balls, xyz, csv and vtp", word));
}

PackingFormat packing_format(const std::filesystem::path& path) {
  try {
    return packing_format(std::string_view(path.extension().string()));
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {} (told by a file's extension)", path.string(), error.what()));
  }
}

void write_packing(const std::filesystem::path& path, const Packing& packing, PackingFormat format) {
  switch (format) {
    case PackingFormat::balls:
      return write_atomically(path, {reinterpret_cast<const char*>(packing.balls.data()), packing.balls.size() * sizeof(Ball)});
    case PackingFormat::xyz:
      return write_atomically(path, to_xyz(packing.balls));
    case PackingFormat::csv:
      return write_atomically(path, to_csv(packing.balls));
    case PackingFormat::vtp:
      return write_atomically(path, to_vtp(packing.balls));
    case PackingFormat::lammps_dump:
    case PackingFormat::lammps_data:
      throw std::logic_error("write_packing: LAMMPS' formats are only read");
  }
}

namespace {

// By the extension; where that says nothing (dump.bed, data.bed), by the first line.
PackingFormat format_of(const std::filesystem::path& path, std::string_view text) {
  const std::string extension = path.extension().string();
  constexpr std::pair<std::string_view, PackingFormat> kKnown[] = {
      {".balls", PackingFormat::balls},      {".xyz", PackingFormat::xyz},          {".csv", PackingFormat::csv},
      {".vtp", PackingFormat::vtp},          {".dump", PackingFormat::lammps_dump}, {".lammpstrj", PackingFormat::lammps_dump},
      {".data", PackingFormat::lammps_data}, {".lmp", PackingFormat::lammps_data}};
  for (const auto& [known, format] : kKnown)
    if (extension == known) return format;
  const std::string_view first = text.substr(0, std::min(text.find('\n'), std::size_t{256}));
  if (first.starts_with("ITEM:")) return PackingFormat::lammps_dump;
  if (first.find("LAMMPS") != first.npos) return PackingFormat::lammps_data;
  const std::string unknown =
      extension.empty() ? "no extension" : fmt::format("no packing format has the extension \"{}\"", extension);
  throw InputError(
      fmt::format("{}: {}; .balls, .xyz, .csv, LAMMPS' .dump (or .lammpstrj) and .data "
                  "(or .lmp) can be read, and any file that begins as LAMMPS' do",
                  path.string(), unknown));
}

}  // namespace

PackingFile read_packing_file(const std::filesystem::path& path, std::optional<std::int64_t> timestep) {
  const FileBytes bytes(path);
  const std::string_view text = bytes.text();
  const std::string where = path.string();
  PackingFile file;
  switch (format_of(path, text)) {
    case PackingFormat::balls:
      file.packing.balls = parse_balls(text, where);
      break;
    case PackingFormat::xyz:
      file.packing.balls = parse_xyz(text, where);
      break;
    case PackingFormat::csv:
      file.packing.balls = parse_csv(text, where);
      break;
    case PackingFormat::vtp:
      throw InputError(fmt::format("{}: .vtp files are only written, not read; .xyz keeps all of it too", where));
    case PackingFormat::lammps_dump:
      file = parse_lammps_dump(text, where, timestep);
      break;
    case PackingFormat::lammps_data:
      file = parse_lammps_data(text, where);
      break;
  }
  if (timestep && file.timestep && *timestep != *file.timestep)
    throw InputError(fmt::format("{}: is of timestep {}, not {}", where, *file.timestep, *timestep));
  file.packing.name = path.stem().string();
  validate(file.packing.balls, where);
  return file;
}

std::vector<std::string> notes_on(const PackingFile& file, bool timestep_was_chosen) {
  std::vector<std::string> notes;
  if (file.snapshots > 1 && !timestep_was_chosen)
    notes.push_back(
        fmt::format("timestep {}, the last of {} snapshots; --timestep chooses another", *file.timestep, file.snapshots));
  const std::int64_t across = contacts_across(file.packing.balls, file.box, Boundary::periodic);
  if (across > 0)
    notes.push_back(fmt::format("the box is periodic in {}: {} contacts across it are left out, as the box is taken as open",
                                file.box.axes(Boundary::periodic), across));
  const std::int64_t perhaps = contacts_across(file.packing.balls, file.box, Boundary::unknown);
  if (perhaps > 0)
    notes.push_back(
        fmt::format("the file does not say whether the box is periodic in {}; it is taken as open, which leaves out {} contacts "
                    "if it is",
                    file.box.axes(Boundary::unknown), perhaps));
  return notes;
}

Packing read_packing(const std::filesystem::path& path) {
  PackingFile file = read_packing_file(path);
  if (const std::int64_t across = contacts_across(file.packing.balls, file.box, Boundary::periodic); across > 0)
    throw InputError(
        fmt::format("{}: the box is periodic in {}; {} contacts across it would be lost, as only open boxes are known",
                    path.string(), file.box.axes(Boundary::periodic), across));
  return std::move(file.packing);
}

}  // namespace touchstone
