#include "datasets/formats.h"

#include <fmt/format.h>

#include <cstring>

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
  throw InputError(fmt::format("\"{}\" is no packing format; known are balls, xyz, csv and vtp", word));
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
  }
}

Packing read_packing(const std::filesystem::path& path) {
  const PackingFormat format = packing_format(path);
  const std::string bytes = read_whole(path), where = path.string();
  Packing packing{path.stem().string(), {}, 0};
  switch (format) {
    case PackingFormat::balls:
      packing.balls = parse_balls(bytes, where);
      break;
    case PackingFormat::xyz:
      packing.balls = parse_xyz(bytes, where);
      break;
    case PackingFormat::csv:
      packing.balls = parse_csv(bytes, where);
      break;
    case PackingFormat::vtp:
      throw InputError(fmt::format("{}: .vtp files are only written; .xyz, .csv and .balls can be read", where));
  }
  validate(packing.balls, where);
  return packing;
}

}  // namespace touchstone
