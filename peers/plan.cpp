#include <fmt/format.h>

#include <regex>

#include "bench/detectors.h"
#include "bench/studies/studies.h"
#include "peers/program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr std::int64_t kManyBalls = 1'000'000;

std::regex compile(const std::string& text, const char* option) {
  try {
    return std::regex(text);
  } catch (const std::regex_error& e) {
    throw InputError(fmt::format("{} '{}' is no regular expression: {}", option, text, e.what()));
  }
}

Case peer_case(const DetectorInfo& info, const PackingSpec& packing, Order order, const PeerSelection& selection) {
  Case c = case_of(Protocol::best, &info, packing);
  c.study = "peers";
  c.output = OutputForm::pairs;
  c.order = order;
  c.phases = on_gpu(info) && balls_of(packing) < kManyBalls;  // a hundred samples more
  c.budget_s = selection.budget_s > 0 ? selection.budget_s : balls_of(packing) < kManyBalls ? 2 : 4;
  return c;
}

}  // namespace

std::vector<PackingSpec> peer_packings() {
  std::vector<PackingSpec> packings{bed(2969, 4), bed(48928, 4), bed(140063, 4)};
  for (const double cell_factor : {4, 1}) {
    PackingSpec tiled = bed(50000, cell_factor);
    tiled.tiled = 10'000'000;
    packings.push_back(tiled);
  }
  return packings;
}

std::vector<Case> plan_peers(const std::vector<const DetectorInfo*>& ours, const std::vector<Peer>& peers,
                             const PeerSelection& selection) {
  const std::regex packings = compile(selection.only_packings, "--packings");
  const std::regex detectors = compile(selection.only_detectors, "--detectors");
  std::vector<Case> cases;
  const auto add = [&](const DetectorInfo& info, const PackingSpec& packing, Order order) -> Case& {
    return cases.emplace_back(peer_case(info, packing, order, selection));
  };
  for (const PackingSpec& packing : selection.packings.empty() ? peer_packings() : selection.packings)
    for (const Order order : {Order::shuffled, Order::sorted}) {
      if (order == Order::sorted && packing.tiled == 0) continue;  // what the caches hold has no order to speak of
      for (const DetectorInfo* info : ours) add(*info, packing, order);
      for (const Peer& peer : peers)
        for (const PeerRow& row : peer.rows) {
          Case& c = add(row.info, packing, order);
          if (balls_of(packing) > row.most_balls)
            c.left_out =
                fmt::format("time: {} is measured to {} balls: beyond, a sample takes seconds", row.info.label(), row.most_balls);
        }
    }
  std::erase_if(cases, [&](const Case& c) {
    return !std::regex_search(name_of(c.packing), packings) || !std::regex_search(c.detector->label(), detectors);
  });
  return cases;
}

Json peers_json(const std::vector<Peer>& peers) {
  Json j = Json::object();
  for (const Peer& peer : peers)
    for (const auto& [key, value] : peer.facts()) j[std::string(peer.name)][key] = value;
  return {{"peers", j}};
}

}  // namespace touchstone
