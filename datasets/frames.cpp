#include "datasets/frames.h"

#include <fmt/format.h>

#include <cstring>
#include <optional>
#include <string_view>
#include <vector>

#include "datasets/file_bytes.h"
#include "datasets/files.h"
#include "datasets/settle.h"
#include "datasets/store.h"
#include "touchstone/error.h"
#include "touchstone/hex.h"

namespace touchstone {
namespace {

constexpr const char* kFormat = "touchstone-frames/1";
constexpr std::size_t kFrames = kLastFrame + 1;

struct Position {
  float x, y, z;
};
static_assert(sizeof(Position) == 12, "the file's bytes");

// The step whose positions are frame f; frames are equally spaced to within one step.
std::int64_t step_of(std::int64_t frame, std::int64_t steps) { return (frame * steps + kLastFrame / 2) / kLastFrame; }

// The bed with its balls elsewhere.
std::vector<Ball> moved(const Packing& bed, const Position* position) {
  std::vector<Ball> balls = bed.balls;
  for (std::size_t i = 0; i < balls.size(); ++i) balls[i] = {position[i].x, position[i].y, position[i].z, balls[i].r};
  return balls;
}

// Frame `spec.frame` out of the file, if it can be trusted. `why_not` tells why it cannot; "" if there is no file.
std::optional<Packing> load(const PackingSpec& spec, const Packing& bed, const std::filesystem::path& path,
                            std::string& why_not) {
  why_not.clear();
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto damaged = [&](const char* why) {
    why_not = fmt::format("{}: {}", path.string(), why);
    return std::nullopt;
  };
  const FileBytes file(path);
  const std::size_t end = std::min(file.text().find('\n'), file.text().size());
  const nlohmann::json header = nlohmann::json::parse(file.text().substr(0, end), nullptr, false);
  std::vector<std::string> hashes;
  try {
    if (header.at("format") != kFormat || header.at("generator_version") != kGeneratorVersion)
      return damaged("from another version of the generator");
    if (header.at("spec") != to_string(settled_of(spec)) || header.at("packing_hash") != hex64(packing_hash(bed.balls)))
      return damaged("of another bed");
    hashes = header.at("frame_hashes").get<std::vector<std::string>>();
  } catch (const nlohmann::json::exception&) {
    return damaged("its first line is damaged");
  }
  const std::size_t frame_bytes = bed.balls.size() * sizeof(Position);
  if (hashes.size() != kFrames || file.text().size() != end + 1 + kFrames * frame_bytes) return damaged("has the wrong size");
  std::vector<Position> position(bed.balls.size());
  const auto frame = static_cast<std::size_t>(spec.frame);
  std::memcpy(position.data(), file.text().data() + end + 1 + frame * frame_bytes, frame_bytes);
  Packing packing{name_of(spec), moved(bed, position.data()), spec.seed};
  if (hex64(packing_hash(packing.balls)) != hashes[frame]) return damaged("damaged (a frame's hash differs)");
  return packing;
}

// Takes frames out of a settling of `steps` steps.
class Recorder {
 public:
  Recorder(const Packing& bed, std::int64_t steps) : bed_(bed), steps_(steps) { positions_.reserve(kFrames * bed.balls.size()); }

  void see(std::int64_t step, const std::vector<Body>& bodies, const std::vector<std::int32_t>& id) {
    if (next_ == kLastFrame || step != step_of(next_, steps_)) return;
    std::vector<Position> frame(bodies.size());
    for (std::size_t k = 0; k < bodies.size(); ++k)
      frame[id[k]] = {static_cast<float>(bodies[k].x), static_cast<float>(bodies[k].y), static_cast<float>(bodies[k].z)};
    add(frame);
  }
  void add_bed() {
    std::vector<Position> frame;
    for (const Ball& b : bed_.balls) frame.push_back({b.x, b.y, b.z});
    add(frame);
  }
  bool complete() const { return next_ == kLastFrame + 1; }

  std::string file_bytes(const PackingSpec& settled) const {
    std::string text = nlohmann::json{{"format", kFormat},
                                      {"spec", to_string(settled)},
                                      {"generator_version", kGeneratorVersion},
                                      {"packing_hash", hex64(packing_hash(bed_.balls))},
                                      {"n", settled.n},
                                      {"frames", kFrames},
                                      {"steps", steps_},
                                      {"frame_hashes", hashes_}}
                           .dump() +
                       "\n";
    return text.append(reinterpret_cast<const char*>(positions_.data()), positions_.size() * sizeof(Position));
  }

 private:
  void add(const std::vector<Position>& frame) {
    positions_.insert(positions_.end(), frame.begin(), frame.end());
    hashes_.push_back(hex64(packing_hash(moved(bed_, frame.data()))));
    ++next_;
  }

  const Packing& bed_;
  std::int64_t steps_;
  std::int32_t next_ = 0;
  std::vector<Position> positions_;
  std::vector<std::string> hashes_;
};

// How long the bed took to settle: only that says which steps are frames.
std::int64_t steps_of(const Packing& bed, const std::filesystem::path& folder) {
  const auto cached = cached_meta(folder / (bed.name + ".balls"), packing_hash(bed.balls));
  if (!cached) throw std::runtime_error(fmt::format("packing {}: its .json went away while its frames were made", bed.name));
  const auto steps = cached->meta.at("settling").at("steps").get<std::int64_t>();
  if (steps < kLastFrame)
    throw InputError(fmt::format("packing {} settles in {} steps: too few for {} frames", bed.name, steps, kFrames));
  return steps;
}

std::string make_frames(const PackingSpec& settled, const Packing& bed, std::int64_t steps, const Progress& progress) {
  Recorder recorder(bed, steps);
  SettledState state;
  const Packing again = settle(settled, state, progress, {},
                               [&](std::int64_t step, const auto& bodies, const auto& id) { recorder.see(step, bodies, id); });
  if (packing_hash(again.balls) != packing_hash(bed.balls) || state.steps != steps)
    throw std::runtime_error(fmt::format("packing {}: settled anew it has other bytes than the cached one", bed.name));
  recorder.add_bed();
  if (!recorder.complete()) throw std::logic_error("frames: a step was not seen");
  return recorder.file_bytes(settled);
}

}  // namespace

Packing load_or_make_frame(const PackingSpec& spec, const std::filesystem::path& folder, const Progress& progress) {
  if (spec.frame < 0 || spec.frame > kLastFrame || spec.kind != PackingKind::settled)
    throw std::logic_error("load_or_make_frame: no frame of a settled packing");
  const PackingSpec settled = settled_of(spec);
  const Packing bed = load_or_make(settled, folder, progress);
  const std::filesystem::path path = folder / cache_file_of(spec);
  // As for packings: files are replaced whole, so a look needs no lock.
  std::string why_not;
  if (std::optional<Packing> cached = load(spec, bed, path, why_not)) return *std::move(cached);
  const FileLock lock(path.string() + ".lock", wait_for_maker(path.filename(), folder, progress));
  if (std::optional<Packing> cached = load(spec, bed, path, why_not)) return *std::move(cached);
  if (!why_not.empty()) fmt::print(stderr, "{}; made anew\n", why_not);
  write_atomically(path, make_frames(settled, bed, steps_of(bed, folder), progress));
  std::optional<Packing> made = load(spec, bed, path, why_not);
  if (!made) throw std::runtime_error(why_not + " right after it was written");
  return *std::move(made);
}

}  // namespace touchstone
