// Does the plan of detector `levels` choose as well as a search would? On packings of many size ratios and distributions: the
// time as planned, the best that a search over levels, cells and lanes finds, and the recipe of Krijgsman, Ogarko and Luding.
// Always by the kernels of more than 8,192 balls: what searches fewer (bucketed_levels.cu) is not tried here.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <regex>

#include "bench/case_runner.h"
#include "bench/command_line.h"
#include "bench/detectors.h"
#include "bench/eta.h"
#include "bench/interrupt.h"
#include "bench/level_recipe.h"
#include "bench/level_search.h"
#include "bench/machine.h"
#include "bench/output_folder.h"
#include "bench/search.h"
#include "bench/studies/studies.h"
#include "datasets/loose.h"
#include "datasets/store.h"
#include "kernels/levels.h"
#include "touchstone/contact.h"

namespace touchstone {
namespace {

constexpr double kBar = 1.10;          // the plan's time over the best found
constexpr int kSamples = 15;           // of a candidate
constexpr int kFinalSamples = 45;      // of each finalist, in turns
constexpr std::size_t kFinalists = 4;  // beside the plan and the recipe
constexpr double kWarmUpMs = 3;

struct Options {
  std::string packings = ".*", out;
  std::int32_t n = 50000;
  std::uint64_t seed = 1;
  double seconds = 170;
  bool list = false, settled = false, force = false;
};

std::vector<PackingSpec> specs_of(const Options& o) {
  const std::regex wanted(o.packings);
  std::vector<PackingSpec> specs;
  for (const double factor : {1, 2, 3, 4, 5, 6, 10, 20, 50, 100})
    for (const Mix mix : {Mix::table1, Mix::uniform, Mix::power_law}) {
      if (factor == 1 && mix != Mix::table1) continue;  // the same balls
      PackingSpec spec = o.settled && mix == Mix::table1 && factor <= 6 ? bed(o.n, factor) : loose(mix, o.n, factor);
      spec.seed = o.seed;
      if (std::regex_search(name_of(spec), wanted)) specs.push_back(spec);
    }
  return specs;
}

Packing packing_of(const PackingSpec& spec) {
  if (spec.kind == PackingKind::loose) return make_loose(spec);
  return load_or_make(spec, source_packing_folder(), [](double, std::string_view) { stop_if_interrupted(); });
}

// The plan in words of a choice.
LevelChoice plan_of(const PackingFacts& facts) {
  const LevelChoice cells = with_fewer_cells(facts.n, facts, LevelOptions{}.large_from);
  const LevelGrids grids = plan_level_grids(facts, cells);
  LevelChoice plan;
  plan.bounds.emplace();
  for (int l = 0; l + 1 < grids.levels; ++l) plan.bounds->push_back(grids.level[l].radius);
  return plan;
}

LevelChoice recipe_of(const PackingFacts& facts) {
  LevelChoice recipe;
  recipe.bounds = recipe_bounds(facts, LevelGrids::kMost);
  recipe.cell_x = recipe.cell_yz = 2;
  recipe.cells_a_ball = 4;  // however many balls: the plan's fewer are not the recipe's
  return recipe;
}

std::string text_of(const LevelChoice& c, const PackingFacts& facts) {
  std::string bounds;
  for (const float b : c.bounds.value_or(std::vector<float>()))
    bounds += fmt::format("{}{:.4g}", bounds.empty() ? "" : ", ", b / facts.rmin);
  const auto or_plan = [](double v) { return v > 0 ? fmt::format("{:g}", v) : std::string("plan"); };
  return fmt::format("bounds [{}] rmin, cells {} x {} R up to {} a ball, {} asked, lanes {}/{}/{}", bounds, or_plan(c.cell_x),
                     or_plan(c.cell_yz), or_plan(c.cells_a_ball), c.asked_levels < 0 ? "plan" : fmt::format("{}", c.asked_levels),
                     or_plan(c.lanes_finest), or_plan(c.lanes_own), or_plan(c.lanes_finer));
}

int list(const Options& o) {
  for (const PackingSpec& spec : specs_of(o)) {
    if (spec.kind == PackingKind::settled) {
      fmt::print("{}: settled\n", name_of(spec));
      continue;
    }
    const PackingFacts facts = facts_of(packing_of(spec).balls);
    const LevelChoice plan = plan_of(facts), recipe = recipe_of(facts);
    const std::vector<float> candidates = bound_candidates(facts, *plan.bounds);
    fmt::print("{}: {} sets of {} bounds\n  planned  {}\n  recipe   {}\n", name_of(spec),
               LevelSearch::combinations(candidates).size(), candidates.size(), text_of(plan, facts), text_of(recipe, facts));
  }
  return kExitOk;
}

#if defined(TOUCHSTONE_HAVE_CUDA)

Json json_of(const LevelChoice& c) {
  const auto or_null = [](auto v) { return v > 0 ? Json(v) : Json(nullptr); };  // null: as planned
  Json bounds = Json::array();
  for (const float b : c.bounds.value_or(std::vector<float>())) bounds.push_back(100.0 * b);
  return {{"bounds_cm", bounds},
          {"cell_x_radii", or_null(c.cell_x)},
          {"cell_yz_radii", or_null(c.cell_yz)},
          {"cells_a_ball", or_null(c.cells_a_ball)},
          {"asked_levels", c.asked_levels < 0 ? Json(nullptr) : Json(c.asked_levels)},
          {"lanes_finest", or_null(c.lanes_finest)},
          {"lanes_own", or_null(c.lanes_own)},
          {"lanes_finer", or_null(c.lanes_finer)}};
}

const DetectorInfo& levels_row() { return find_detector("levels"); }

// One packing, resident; detectors come and go.
class Bed {
 public:
  explicit Bed(Packing packing) : context_(std::move(packing)), stream_(timing_stream(Place::device)) {
    d_.balls = Buffer<Ball>(context_.packing.balls.size(), Place::device, stream_);
    copy_async(d_.balls, std::span<const Ball>(context_.packing.balls), stream_);
    context_.reference();
  }

  PackingContext& context() { return context_; }

  // The samples of one choice, once its contacts were counted and hashed.
  std::vector<double> measure(const LevelChoice& choice, double give_up_us) {
    make(choice);
    require_same_hash(choice);
    Sampler sampler = sampler_of(*d_.detector);
    sampler.warm_up_us(0);
    std::vector<double> us;
    while (std::ssize(us) < kSamples) {
      stop_if_interrupted();
      us.push_back(sampler.sample_us());
      if (std::ssize(us) == kFirstSamples && *std::min_element(us.begin(), us.end()) > give_up_us) break;
    }
    return us;
  }

  // Samples of several choices in turns, each set compared contact by contact before, and counted and hashed after.
  std::vector<std::vector<double>> contest(const std::vector<LevelChoice>& choices) {
    std::vector<std::unique_ptr<Detector>> detectors;
    std::vector<Sampler> samplers;
    for (const LevelChoice& c : choices) {
      make(c);
      if (const std::string difference = mismatch(d_, context_.reference(), stream_); !difference.empty())
        throw Mismatch(fmt::format("{}: {}: {}", context_.packing.name, text_of(c, context_.facts), difference), "levels");
      detectors.push_back(std::move(d_.detector));
      samplers.push_back(sampler_of(*detectors.back()));
      samplers.back().warm_up_us(kWarmUpMs);
    }
    std::vector<std::vector<double>> us(choices.size());
    for (int k = 0; k < kFinalSamples; ++k)
      for (std::size_t c = 0; c < choices.size(); ++c) {
        stop_if_interrupted();
        samplers[c].sample_us();  // the one before was another's: this one finds its own state in the caches
        us[c].push_back(samplers[c].sample_us());
      }
    for (std::size_t c = 0; c < choices.size(); ++c) {
      samplers[c].sample_us();
      d_.report = detectors[c]->report(d_.output->view(), stream_);
      require_same_hash(choices[c]);
    }
    return us;
  }

 private:
  void make(const LevelChoice& choice) {
    d_.detector.reset();
    d_.detector = make_levels_as(context_.facts, {}, {.few_up_to = 0, .choice = choice}, stream_);
    complete_detection(d_, levels_row(), context_.facts, {}, OutputForm::pairs, stream_,
                       std::max<std::int64_t>(context_.reference().contacts, 64));
  }

  Sampler sampler_of(Detector& detector) {
    return Sampler([this, &detector] { detector.detect(d_.input(), d_.output->view(), stream_); }, Place::device, Launch::graph,
                   Cache::hot, stream_);
  }

  // Order-independent and quick: what a search can afford for each candidate.
  void require_same_hash(const LevelChoice& choice) {
    const Reference& reference = context_.reference();
    std::uint64_t hash = 0;
    if (d_.report.contacts == reference.contacts)
      for (const Pair& p : download(d_.output->view().pair, static_cast<std::size_t>(d_.report.contacts), stream_))
        hash += contact_hash_term(p.i, p.j);
    if (d_.report.contacts != reference.contacts || hash != reference.hash)
      throw Mismatch(fmt::format("{}: {}: {} contacts with hash {}, reference {} with {}", context_.packing.name,
                                 text_of(choice, context_.facts), d_.report.contacts, hex64(hash), reference.contacts,
                                 hex64(reference.hash)),
                     "levels");
  }

  PackingContext context_;
  Stream& stream_;
  Detection d_;
};

Json standing_json(const LevelChoice& choice, const std::vector<double>& us) {
  const Quartiles q = quartiles(us);
  Json j = json_of(choice);
  j["median_us"] = q.median, j["q1_us"] = q.q1, j["q3_us"] = q.q3, j["samples_us"] = us;
  return j;
}

// One row of the result; `seconds` is what its search may take.
Json prove(const PackingSpec& spec, double seconds) {
  using Clock = std::chrono::steady_clock;
  const auto begin = Clock::now();
  Bed bed(packing_of(spec));
  const PackingFacts& facts = bed.context().facts;
  const auto late = [&] { return std::chrono::duration<double>(Clock::now() - begin).count() > seconds; };
  LevelSearch search(
      facts, plan_of(facts), [&](const LevelChoice& c, double give_up) { return bed.measure(c, give_up); }, late);
  search.run();

  std::vector<LevelChoice> choices{plan_of(facts), recipe_of(facts)};
  for (const std::size_t k : search.best(kFinalists)) choices.push_back(search.trials()[k].choice);
  const std::vector<std::vector<double>> us = bed.contest(choices);
  std::size_t best = 0;
  for (std::size_t c = 1; c < choices.size(); ++c)
    if (quartiles(us[c]).median < quartiles(us[best]).median) best = c;

  const double planned_us = quartiles(us[0]).median, recipe_us = quartiles(us[1]).median, best_us = quartiles(us[best]).median;
  const auto count = [&](auto is) { return std::count_if(search.trials().begin(), search.trials().end(), is); };
  Json row = {{"packing", name_of(spec)},
              {"packing_hash", hex64(packing_hash(bed.context().packing.balls))},
              {"kind", to_string(spec.kind)},
              {"mix", to_string(spec.mix)},
              {"cell_factor", spec.cell_factor},
              {"n", spec.n},
              {"seed", spec.seed},
              {"contacts", bed.context().reference().contacts},
              {"contact_hash", hex64(bed.context().reference().hash)},
              {"verified_by", bed.context().reference().by},
              {"planned_us", planned_us},
              {"best_us", best_us},
              {"recipe_us", recipe_us},
              {"planned_over_best", planned_us / best_us},
              {"recipe_over_best", recipe_us / best_us},
              {"tried", search.trials().size()},
              {"pruned", count([](const LevelTrial& t) { return t.pruned; })},
              {"refused", count([](const LevelTrial& t) { return !t.refused.empty(); })},
              {"cut", search.cut()},
              {"planned", standing_json(choices[0], us[0])},
              {"best", standing_json(choices[best], us[best])},
              {"recipe", standing_json(choices[1], us[1])}};
  Json trials = Json::array();
  for (const LevelTrial& t : search.trials()) {
    Json j = json_of(t.choice);
    j["stage"] = t.stage, j["us"] = t.us;
    if (!t.refused.empty()) j["refused"] = t.refused;
    trials.push_back(std::move(j));
  }
  row["trials"] = std::move(trials);
  const LevelChoice& winner = choices[best];
  fmt::print("{:<34} {:>8.2f} {:>8.2f} {:>6.3f} {:>8.2f} {:>6.3f}  {}{}\n", name_of(spec), planned_us, best_us,
             planned_us / best_us, recipe_us, recipe_us / best_us, text_of(winner, facts), search.cut() ? "; cut short" : "");
  std::fflush(stdout);
  return row;
}

Json head(const std::vector<std::string>& argv, const Options& o, const std::vector<std::string>& why_not) {
  return {{"schema", "touchstone-levels-proof/1"},
          {"run", {{"start", utc_now()}, {"argv", argv}, {"seconds", o.seconds}, {"complete", false}, {"why_not", why_not}}},
          {"source", source_json()},
          {"build", build_json()},
          {"host", host_json()},
          {"device", device_json()},
          {"calibration", calibration_json()},
          {"state", {{"start", state_json()}}},
          {"how",
           {{"timed_region", "positions and radii resident -> pair list complete; graph, hot"},
            {"threads", {level_threads(o.n).broad, level_threads(o.n).narrow}},
            {"samples", kSamples},
            {"pruned_if", fmt::format("none of the first {} samples is below {} times the best so far", kFirstSamples, kGiveUp)},
            {"final", fmt::format("the plan, the recipe and the best {} of the search, {} samples each in turns", kFinalists,
                                  kFinalSamples)},
            {"verified", "every candidate by count and hash, every finalist contact by contact"},
            {"recipe", "Krijgsman, Ogarko and Luding 2014, bench/level_recipe.h"}}},
          {"bar", kBar},
          {"worst", nullptr},
          {"packings", Json::array()}};
}

int prove_all(const Options& o, const std::vector<std::string>& argv) {
  const int others = other_compute_processes();  // before our own context
  const std::vector<std::string> why_not = forced_refusals(build_json(), device_json(), others, o.force);
  if (!o.out.empty()) require_writable_file(o.out);
  const std::vector<PackingSpec> specs = specs_of(o);
  if (specs.empty()) {
    fmt::print(stderr, "bench_levels: nothing to do: no packing matches '{}' (--list names them)\n", o.packings);
    return kExitNothingRan;
  }
  catch_interrupts();
  Json file = head(argv, o, why_not);
  const auto begin = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(); };
  const auto write = [&] {
    file["run"]["end"] = utc_now(), file["state"]["end"] = state_json();
    if (!o.out.empty()) write_atomically(o.out, file.dump(2) + "\n");
  };
  Eta eta(o.seconds);
  double worst = 0;
  fmt::print("{:<34} {:>8} {:>8} {:>6} {:>8} {:>6}  best found\n", "packing", "plan us", "best us", "ratio", "recipe", "ratio");
  try {
    for (std::size_t k = 0; k < specs.size(); ++k) {
      eta.show(elapsed(), fmt::format("[{}/{}] {}", k + 1, specs.size(), name_of(specs[k])));
      const double left = std::max(0.0, o.seconds - elapsed());
      file["packings"].push_back(prove(specs[k], left / static_cast<double>(specs.size() - k)));
      worst = std::max(worst, file["packings"].back()["planned_over_best"].get<double>());
      file["worst"] = worst;
      write();  // what is done is kept, whatever comes
    }
  } catch (const Interrupted&) {
    write();
    eta.end();
    fmt::print(stderr, "bench_levels: interrupted; {} of {} packings are done{}\n", file["packings"].size(), specs.size(),
               o.out.empty() ? "" : " and written");
    return kExitInterrupted;
  }
  file["run"]["complete"] = true;
  write();
  eta.end();
  fmt::print("worst of {}: {:.3f}, bar {:.2f}: {}\n", specs.size(), worst, kBar, worst <= kBar ? "met" : "missed");
  return kExitOk;
}

#else

int prove_all(const Options&, const std::vector<std::string>&) {
  throw NoGpuError("`levels` runs on a GPU: " + why_no_gpu() + "; --list shows what would be tried");
}

#endif

}  // namespace
}  // namespace touchstone

int main(int argc, char** argv) {
  using namespace touchstone;
  return guarded("bench_levels", [&] {
    Options o;
    CLI::App app{
        "Times `levels` as planned, as the best of a search over levels, cells and lanes, and as a published recipe has it."};
    app.add_option("--packings", o.packings, "regular expression, searched in packing names")->capture_default_str();
    app.add_option("--n", o.n, "balls of a packing; up to 8,192 `levels` itself has other kernels, which are not tried here")
        ->check(CLI::Range(1000, 10'000'000))
        ->capture_default_str();
    app.add_option("--seed", o.seed, "of the packings")->capture_default_str();
    app.add_option("--seconds", o.seconds, "budget; a search that it cuts short is said")->capture_default_str();
    app.add_option("--out", o.out, "write the result as JSON");
    app.add_flag("--settled", o.settled, "settled packings of Table 1's mixture up to C = 6, made where absent; else loose ones");
    app.add_flag("--list", o.list, "print the packings, their plans and the recipe's, and stop; needs no GPU");
    app.add_flag("--force", o.force, "measure although the run would be refused; the record says so");
    if (const int code = parse(app, argc, argv); code >= 0) return code;
    if (!(o.seconds > 0)) throw InputError(fmt::format("--seconds {}: a positive number", o.seconds));
    try {
      if (o.list) return list(o);
#if defined(TOUCHSTONE_HAVE_CUDA)
      if (!gpu_usable()) throw NoGpuError("`levels` runs on a GPU: " + why_no_gpu() + "; --list shows what would be tried");
#endif
      return prove_all(o, {argv, argv + argc});
    } catch (const std::regex_error& e) {
      throw InputError(fmt::format("--packings '{}' is no regular expression: {}", o.packings, e.what()));
    } catch (const Mismatch& e) {
      fmt::print(stderr, "bench_levels: contact set differs from the reference: {}\n", e.what());
      return static_cast<int>(kExitMismatch);
    }
  });
}
