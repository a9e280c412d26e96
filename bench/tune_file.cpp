#include "bench/tune_file.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <limits>

#include "bench/detectors.h"
#include "bench/gpu_facts.h"
#include "bench/machine.h"
#include "bench/strict_json.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

constexpr double kRadiiAlike = 0.01, kSizeAlike = 2;

Json positive_or_null(double value) { return value > 0 ? Json(value) : Json(nullptr); }
Json positive_or_null(int value) { return value > 0 ? Json(value) : Json(nullptr); }

Json point_json(const DetectorInfo& info, const SearchPoint& at, const PackingFacts& facts) {
  const Tuning t = tuning_at(info, at);
  return {{"cell_ravg", positive_or_null(t.cell_ravg)},
          {"cell_rmax", positive_or_null(t.cell_rmax)},
          {"cell_cm", positive_or_null(round_cm(cell_of(t, facts)))},
          {"threads_broad", positive_or_null(t.threads_broad)},
          {"threads_narrow", positive_or_null(t.threads_narrow)}};
}

Json standing_json(const Standing& s) {
  Json j;
  j["cell_cm"] = positive_or_null(round_cm(s.used.cell > 0 ? s.used.cell : s.asked.cell));
  j["threads_broad"] = positive_or_null(s.asked.threads_broad);
  j["threads_narrow"] = positive_or_null(s.asked.threads_narrow);
  if (!s.refused.empty()) {
    j["refused"] = s.refused;
    return j;
  }
  const Interval i = interval_of_rounds(s.rounds_us);
  j["median_us"] = i.middle;
  j["low_us"] = i.low;
  j["high_us"] = i.high;
  j["rounds_us"] = s.rounds_us;
  j["bytes"] = s.bytes;
  return j;
}

Json ratio_json(const Standing& slower, const Standing& faster) {
  const Ratio r = ratio_of(slower, faster);
  return {{"ratio", r.interval.middle}, {"low", r.interval.low}, {"high", r.interval.high}, {"verdict", r.verdict}};
}

Json candidates_json(const Tuned& t, const std::vector<Trial>& trials, const PackingFacts& facts) {
  Json list = Json::array();
  for (const Trial& trial : trials) {
    Json j = point_json(*t.info, trial.at, facts);
    j["lower_quartile_us"] = trial.refused.empty() ? Json(trial.cost()) : Json(nullptr);
    j["samples"] = trial.costs.size();
    j["refused"] = trial.refused.empty() ? Json(nullptr) : Json(trial.refused);
    list.push_back(std::move(j));
  }
  return list;
}

Json tuned_json(const TuneResult& result, const Tuned& t, const PackingFacts& facts) {
  Json j;
  j["detector"] = t.info->label();
  j["place"] = on_gpu(*t.info) ? "gpu" : "cpu";
  j["search_cut"] = t.cut;
  if (t.chosen) {
    j["chosen"] = point_json(*t.info, *t.chosen, facts);
    j["cell_at_edge_of_search"] = t.at_edge;
    const Standing& mine = result.standing(t);
    j["contest"] = standing_json(mine);
    const Standing& rule = result.standings[t.rule];
    j["rule"] = t.info->free_cell ? standing_json(rule) : Json(nullptr);
    if (t.info->free_cell && rule.refused.empty() && mine.refused.empty()) j["rule"]["over_rule"] = ratio_json(rule, mine);
    if (t.dense_best) {
      const Standing& dense = result.standings[t.dense_standing];
      j["exhaustive"] = point_json(*t.info, *t.dense_best, facts);
      j["exhaustive"]["contest"] = standing_json(dense);
      if (dense.refused.empty() && mine.refused.empty()) j["exhaustive"]["search_over_exhaustive"] = ratio_json(mine, dense);
      j["exhaustive"]["candidates"] = candidates_json(t, t.dense, facts);
    }
  }
  j["candidates"] = candidates_json(t, t.trials, facts);
  return j;
}

// Reads one key after another; every fault names the file and the key.
class Reader {
 public:
  Reader(const Json& object, std::string where) : object_(object), where_(std::move(where)) {
    if (!object.is_object()) throw InputError(where_ + ": not an object");
  }
  const Json& at(const char* key) const {
    if (!object_.contains(key)) throw InputError(fmt::format("{}: no key '{}'", where_, key));
    return object_[key];
  }
  Reader inner(const char* key) const { return Reader(at(key), where_ + ": " + key); }
  std::string word(const char* key) const {
    if (!at(key).is_string()) fail(key, "a string");
    return at(key);
  }
  double positive(const char* key) const {
    if (!at(key).is_number() || !(at(key).get<double>() > 0) || !std::isfinite(at(key).get<double>()))
      fail(key, "a positive number");
    return at(key);
  }
  double positive_or_null(const char* key) const { return at(key).is_null() ? 0 : positive(key); }
  int threads(const char* key) const {
    if (at(key).is_null()) return 0;
    if (!at(key).is_number_integer() || at(key) < 1 || at(key) > 1024) fail(key, "null or a whole number from 1 to 1024");
    return at(key);
  }
  [[noreturn]] void fail(const char* key, const std::string& wanted) const {
    throw InputError(fmt::format("{}: {} is {}, not {}", where_, key, at(key).dump(), wanted));
  }

 private:
  const Json& object_;
  std::string where_;
};

}  // namespace

std::string tuned_device(Place place) { return place == Place::device ? gpu_name() : host_json()["cpu"].get<std::string>(); }

Json tune_json(const TuneResult& result, const PackingContext& context) {
  const PackingFacts& f = context.facts;
  const Tuned& best = result.tuned.front();
  Json j;
  j["schema"] = kTuneSchema;
  j["created"] = utc_now();
  j["source"] = source_json();
  j["build"] = build_json();
  j["machine"] = {{"cpu", tuned_device(Place::host)},
                  {"cores", host_json()["cores"]},
                  {"gpu", gpu_usable() ? Json(gpu_name()) : Json(nullptr)}};
  j["packing"] = {{"name", context.packing.name},
                  {"packing_hash", hex64(packing_hash(context.packing.balls))},
                  {"n", f.n},
                  {"rmin_cm", round_cm(f.rmin)},
                  {"rmax_cm", round_cm(f.rmax)},
                  {"ravg_cm", round_cm(f.ravg)}};
  Json choice = {{"detector", best.info->label()},
                 {"place", on_gpu(*best.info) ? "gpu" : "cpu"},
                 {"device", tuned_device(best.info->place)},
                 {"output", to_string(result.options.output)},
                 {"launch", on_gpu(*best.info) ? Json(to_string(result.options.launch)) : Json(nullptr)}};
  choice.update(point_json(*best.info, *best.chosen, f));
  choice["median_us"] = result.standing(best).median_us();
  choice["bytes"] = result.standing(best).bytes;
  j["choice"] = std::move(choice);
  j["over_next"] = nullptr;
  if (const Tuned* next = result.next()) {
    j["over_next"] = ratio_json(result.standing(*next), result.standing(best));
    j["over_next"]["detector"] = next->info->label();
  }
  j["over_paper_rule"] = nullptr;
  if (const Standing* paper = result.paper_at_rule()) {
    j["over_paper_rule"] = ratio_json(*paper, result.standing(best));
    j["over_paper_rule"]["detector"] = paper->info->label();
  }
  j["budget"] = {{"seconds", result.options.seconds},
                 {"used_seconds", result.seconds},
                 {"exhaustive_seconds", result.exhaustive_seconds},
                 {"rounds", result.rounds},
                 {"cut", result.cut()}};
  j["detectors"] = Json::array();
  for (const Tuned& t : result.tuned) j["detectors"].push_back(tuned_json(result, t, f));
  j["left_out"] = Json::array();
  for (const auto& [label, why] : result.left_out) j["left_out"].push_back({{"detector", label}, {"why", why}});
  return j;
}

TuneConfig read_tune_config(const std::filesystem::path& path) {
  const Json file = parse_strict_json(read_whole(path), path.string() + ": no JSON");
  const Reader top(file, path.string());
  if (top.word("schema") != kTuneSchema)
    top.fail("schema", std::string("\"") + kTuneSchema + "\" (what `touchstone tune --out` writes)");
  const Reader choice = top.inner("choice"), packing = top.inner("packing");
  TuneConfig c;
  c.detector = choice.word("detector");
  c.place = choice.word("place");
  if (c.place != "cpu" && c.place != "gpu") choice.fail("place", "\"cpu\" or \"gpu\"");
  c.device = choice.word("device");
  c.tuning.cell_ravg = choice.positive_or_null("cell_ravg");
  c.tuning.cell_rmax = choice.positive_or_null("cell_rmax");
  if (c.tuning.cell_ravg > 0 && c.tuning.cell_rmax > 0) choice.fail("cell_rmax", "null beside cell_ravg");
  c.tuning.threads_broad = choice.threads("threads_broad");
  c.tuning.threads_narrow = choice.threads("threads_narrow");
  const std::string output = choice.word("output");
  if (output != "pairs" && output != "ball_lists") choice.fail("output", "\"pairs\" or \"ball_lists\"");
  c.output = output == "pairs" ? OutputForm::pairs : OutputForm::ball_lists;
  const std::string launch = choice.at("launch").is_null() ? "stream" : choice.word("launch");
  if (launch != "stream" && launch != "graph") choice.fail("launch", "\"stream\" or \"graph\"");
  c.launch = launch == "graph" ? Launch::graph : Launch::stream;
  c.packing = packing.word("name");
  if (packing.positive("n") > std::numeric_limits<std::int32_t>::max()) packing.fail("n", "a number of balls below 2^31");
  c.n = static_cast<std::int64_t>(packing.positive("n"));
  c.rmin_cm = packing.positive("rmin_cm");
  c.rmax_cm = packing.positive("rmax_cm");
  c.ravg_cm = packing.positive("ravg_cm");
  c.tuning.tuned_on = c.packing;
  return c;
}

void require_fit(const TuneConfig& config, const DetectorInfo& info, const std::string& where) {
  const auto require = [&](bool taken, bool given, const char* what) {
    if (taken != given)
      throw InputError(fmt::format("{}: choice: {} {} {}", where, info.label(), taken ? "needs" : "takes no", what));
  };
  require(info.free_cell && info.least_cell_rmax == 0, config.tuning.cell_ravg > 0, "cell_ravg");
  require(info.free_cell && info.least_cell_rmax > 0, config.tuning.cell_rmax > 0, "cell_rmax");
  require(info.threads_broad, config.tuning.threads_broad > 0, "threads_broad");
  require(info.threads_narrow, config.tuning.threads_narrow > 0, "threads_narrow");
}

std::vector<std::string> differences(const TuneConfig& config, const PackingFacts& facts) {
  std::vector<std::string> found;
  const auto radius = [&](const char* name, double here_m, double tuned_cm) {
    if (std::abs(100 * here_m - tuned_cm) > kRadiiAlike * tuned_cm)
      found.push_back(fmt::format("{} is {:.4g} cm, tuned on {:.4g} cm", name, 100 * here_m, tuned_cm));
  };
  radius("rmin", facts.rmin, config.rmin_cm);
  radius("ravg", facts.ravg, config.ravg_cm);
  radius("rmax", facts.rmax, config.rmax_cm);
  const double share = static_cast<double>(facts.n) / static_cast<double>(config.n);
  if (share > kSizeAlike || share < 1 / kSizeAlike) found.push_back(fmt::format("{} balls, tuned on {}", facts.n, config.n));
  return found;
}

}  // namespace touchstone
