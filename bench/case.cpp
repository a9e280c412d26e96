#include "bench/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/detectors.h"

namespace touchstone {
namespace {

constexpr double kPaperCell = 0.01;  // m; Table 2

// Of the box that holds all balls, to three decimals: V in (V/N)^(1/3).
double volume_cm3(const PackingFacts& facts) {
  double volume = 1e6;
  for (int axis = 0; axis < 3; ++axis) volume *= static_cast<double>(facts.surfaces.upper[axis]) - facts.surfaces.lower[axis];
  return std::round(1e3 * volume) / 1e3;
}

Json kernels_json(const std::vector<KernelFacts>& kernels) {
  Json list = Json::array();
  for (const KernelFacts& k : kernels)
    list.push_back({{"name", k.name},
                    {"phase", k.phase},
                    {"threads", k.threads},
                    {"static_shared_bytes", k.static_shared_bytes},
                    {"dynamic_shared_bytes", k.dynamic_shared_bytes},
                    {"registers", k.registers},
                    {"blocks_an_sm", k.blocks_an_sm},
                    {"occupancy", k.occupancy}});
  return list;
}

// Of updates, in place of the file's timed_region.
constexpr const char* kTimedUpdate =
    "update() of this packing's balls; before each sample, untimed, detect() of the balls held, and waiting for it";

double way(const Ball& from, const Ball& to) {
  return std::hypot(double{to.x} - from.x, double{to.y} - from.y, double{to.z} - from.z);
}

Json or_null(int value) { return value > 0 ? Json(value) : Json(nullptr); }

}  // namespace

double round_cm(double metres) { return std::round(metres * 1e8) / 1e6; }

std::string_view to_string(Protocol protocol) {
  switch (protocol) {
    case Protocol::paper:
      return "paper";
    case Protocol::best:
      return "best";
    case Protocol::rule:
      return "rule";
    default:
      return "given";
  }
}
std::string_view to_string(Knowledge knowledge) {
  switch (knowledge) {
    case Knowledge::known:
      return "known";
    case Knowledge::first_frame:
      return "first_frame";
    default:
      return "blind";
  }
}

FrameFacts frame_facts(const Packing& frame, const Packing& first, const PackingFacts& facts) {
  FrameFacts f;
  // Numbered by 21 bits an axis: a hostile packing's box has more cells than a Grid can number.
  constexpr int kAxisBits = 21;
  const float per_m = static_cast<float>(1 / (2 * facts.ravg));
  const auto along = [&](float v, int axis) {
    return std::int64_t{cell_coordinate(v, facts.centres.lower[axis], per_m, 1 << kAxisBits)} << (kAxisBits * axis);
  };
  std::map<std::int64_t, std::int64_t> cells;  // number -> balls; few cells are empty, but an outlier's box may be huge
  double all_ways = 0;
  for (std::size_t i = 0; i < frame.balls.size(); ++i) {
    const Ball &now = frame.balls[i], &then = first.balls[i];
    f.balls_a_cell_most = std::max(f.balls_a_cell_most, ++cells[along(now.x, 0) + along(now.y, 1) + along(now.z, 2)]);
    all_ways += way(then, now);
  }
  const auto n = static_cast<double>(frame.balls.size());
  f.balls_a_cell_mean = n / static_cast<double>(cells.size());
  f.moved_ravg = all_ways / n / facts.ravg;
  return f;
}

StepFacts step_facts(const Packing& given, const Packing& held) {
  if (given.balls.size() != held.balls.size())
    throw std::logic_error(fmt::format("{} and {} are not the same balls", given.name, held.name));
  StepFacts s;
  if (held.balls.empty()) return s;
  float rmin = held.balls[0].r;
  for (std::size_t i = 0; i < held.balls.size(); ++i) {
    const Ball &now = given.balls[i], &then = held.balls[i];
    if (now.r != then.r) throw std::logic_error(fmt::format("ball {} of {} has another radius in {}", i, given.name, held.name));
    const double moved = way(then, now);
    s.mean_rmin += moved;
    s.most_rmin = std::max(s.most_rmin, moved);
    rmin = std::min(rmin, then.r);
  }
  s.mean_rmin /= static_cast<double>(held.balls.size()) * rmin;
  s.most_rmin /= rmin;
  return s;
}

std::string Case::name() const {
  std::string name =
      fmt::format("{}/{}/{}/{}/{}", study, to_string(protocol), detector->label(), name_of(packing), to_string(output));
  if (on_gpu(*detector)) name += fmt::format("/{}/{}", to_string(launch), to_string(cache));
  if (given.cell > 0) name += fmt::format("/cell_{:g}cm", round_cm(given.cell));
  if (given.threads_broad > 0) name += fmt::format("/{}x{}", given.threads_broad, given.threads_narrow);
  if (order != Order::shuffled) name += fmt::format("/{}", to_string(order));
  if (knowledge != Knowledge::known) name += fmt::format("/{}", to_string(knowledge));
  if (held) name += fmt::format("/update_from_{}", name_of(*held));
  if (then == Then::force) name += "/force";
  return name;
}

double cell_of(const Tuning& tuning, const PackingFacts& facts) {
  return tuning.cell_ravg > 0 ? tuning.cell_ravg * facts.ravg : tuning.cell_rmax * facts.rmax;
}

DetectorParams params_of(const Case& c, const PackingFacts& facts, const Tuning& tuning) {
  const DetectorInfo& info = *c.detector;
  const double least = info.least_cell_rmax * facts.rmax;
  DetectorParams p = c.protocol == Protocol::given ? c.given : DetectorParams{};
  if (c.held) p.updates = info.updates;
  if (c.protocol == Protocol::given) return p;
  p.cell_capacity = c.given.cell_capacity;
  if (c.protocol == Protocol::best) {
    if (info.free_cell) p.cell = std::max(cell_of(tuning, facts), least);
    p.threads_broad = tuning.threads_broad;
    p.threads_narrow = tuning.threads_narrow;
    return p;
  }
  if (info.free_cell) {
    const double rule = (on_gpu(info) ? 4 : 2) * facts.ravg;
    p.cell = std::max(c.protocol == Protocol::paper ? kPaperCell : rule, least);
  }
  if (info.threads_broad && !info.own_threads) p.threads_broad = kPaperThreadsBroad;
  if (info.threads_narrow && !info.own_threads) p.threads_narrow = kPaperThreadsNarrow;
  return p;
}

Json identity_json(const Case& c, const PackingLabel& packing, const PackingFacts& facts, const Tuning& tuning) {
  const DetectorInfo& info = *c.detector;
  const bool gpu = on_gpu(info);
  Json j;
  j["study"] = c.study;
  j["protocol"] = to_string(c.protocol);
  j["detector"] = info.name;
  j["layout"] = info.layout.empty() ? Json(nullptr) : Json(info.layout);
  j["ablation"] = info.ablation.empty() ? Json(nullptr) : Json(info.ablation);
  j["place"] = gpu ? "gpu" : "cpu";
  j["packing"] = packing.name;
  j["packing_hash"] = hex64(packing.hash);
  j["seed"] = packing.seed;
  j["kind"] = to_string(c.packing.kind);
  j["mix"] = to_string(c.packing.mix);
  j["base_cm"] = {round_cm(c.packing.base_x), round_cm(c.packing.base_y)};  // [0, 0]: a cube
  j["volume_cm3"] = volume_cm3(facts);
  j["n"] = facts.n;
  if (c.packing.tiled != 0) j["tile_balls"] = c.packing.n;
  if (c.packing.frame >= 0) j["frame"] = c.packing.frame;
  if (c.packing.shape != Shape::as_packed) j["shape"] = to_string(c.packing.shape);
  if (c.held) {
    j["held"] = name_of(*c.held);
    j["timed"] = kTimedUpdate;
    j["knows_updates"] = info.updates;  // else its update() is detect()
  }
  j["cell_factor"] = c.packing.cell_factor;
  j["rmin_cm"] = round_cm(facts.rmin);
  j["rmax_cm"] = round_cm(facts.rmax);
  j["ravg_cm"] = round_cm(facts.ravg);
  j["launch"] = gpu ? Json(to_string(c.launch)) : Json(nullptr);
  j["cache"] = to_string(c.cache);
  j["order"] = to_string(c.order);
  j["output"] = to_string(c.output);
  j["knowledge"] = to_string(c.knowledge);
  j["then"] = c.then == Then::force ? Json("force") : Json(nullptr);
  j["known"] = info.known;
  j["tuned_on"] = c.protocol == Protocol::best && !tuning.tuned_on.empty() ? Json(tuning.tuned_on) : Json(nullptr);
  return j;
}

Json case_json(const Case& c, const PackingLabel& packing, const PackingFacts& facts, const Tuning& tuning,
               const Measurement& m) {
  Json j = identity_json(c, packing, facts, tuning);
  const Quartiles q = quartiles(m.samples_us);
  j["cell_cm"] = m.params.cell > 0 ? Json(round_cm(m.params.cell)) : Json(nullptr);
  j["threads_broad"] = or_null(m.params.threads_broad);
  j["threads_narrow"] = or_null(m.params.threads_narrow);
  j["cell_capacity"] = or_null(m.params.cell_capacity);
  j["cells"] = m.report.cells > 0 ? Json(m.report.cells) : Json(nullptr);
  j["fullest_cell"] = m.report.cell.capacity > 0 ? Json(m.report.cell.count) : Json(nullptr);
  j["contacts"] = m.report.contacts;
  j["contact_hash"] = hex64(m.contact_hash);
  j["verified"] = true;  // a mismatch never comes this far
  j["verified_by"] = m.verified_by;
  j["retries"] = m.retries;
  if (c.knowledge == Knowledge::first_frame) j["regrown"] = m.regrown;
  if (m.frame) {
    j["balls_a_cell_mean"] = m.frame->balls_a_cell_mean;
    j["balls_a_cell_most"] = m.frame->balls_a_cell_most;
    if (c.packing.frame >= 0) j["moved_ravg"] = m.frame->moved_ravg;
  }
  if (m.step) {
    j["moved_mean_rmin"] = m.step->mean_rmin;
    j["moved_most_rmin"] = m.step->most_rmin;
  }
  j["median_us"] = q.median;
  j["q1_us"] = q.q1;
  j["q3_us"] = q.q3;
  j["sample_count"] = m.samples_us.size();
  j["bytes_peak"] = m.bytes_peak;
  j["bytes_workspace"] = m.bytes_workspace;
  if (!m.kernels.empty()) j["kernels"] = kernels_json(m.kernels);
  if (!m.phases_us.empty()) {
    j["phases_us"] = Json::object();
    for (const auto& [phase, us] : m.phases_us) j["phases_us"][phase] = us;
  }
  j["provenance"] = "measured";
  j["flags"] = m.flags;
  return j;
}

}  // namespace touchstone
