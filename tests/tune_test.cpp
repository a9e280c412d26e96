// `touchstone tune`: the search on costs whose optimum is known, the contest's statistics, the budget, the file, the programs.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "bench/case_runner.h"
#include "bench/contest.h"
#include "bench/detectors.h"
#include "bench/search.h"
#include "bench/tune_file.h"
#include "bench/tune_report.h"
#include "datasets/files.h"
#include "datasets/spec.h"
#include "datasets/store.h"
#include "tests/results_schema.h"
#include "tests/run_program.h"
#include "touchstone/contact.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_program;
using testing::TemporaryFolder;

// ---- the search, without a clock ----

SearchSpace wide_space() { return {{4, 256, 128}, 1, 24, {64, 128, 256, 512}, {32, 64, 128, 256, 512}}; }
OutOfTime never() {
  return [] { return false; };
}

// A valley like a grid's: building costs c^-3, searching c^3, least at `optimum`; the best threads of the narrow phase grow with
// the cell, those of the broad phase are their own matter.
struct Valley {
  double optimum;
  int narrow_at_4, broad;
  double operator()(const SearchPoint& p) const {
    const double x = p.cell / optimum;
    const double narrow = std::log2(p.threads_narrow / (narrow_at_4 * p.cell / 4)),
                 wide = std::log2(double(p.threads_broad) / broad);
    return 100 * (0.5 * (std::pow(x, -3) + std::pow(x, 3)) + 0.15 * narrow * narrow + 0.05 * wide * wide);
  }
};

double least_on(const std::vector<SearchPoint>& points, const Valley& cost) {
  double least = HUGE_VAL;
  for (const SearchPoint& p : points) least = std::min(least, cost(p));
  return least;
}

double noise(std::uint64_t k) { return 0.9 + 0.2 * static_cast<double>(splitmix64(k) >> 11) * 0x1p-53; }

TEST(Search, ComesWithinTenPercentOfADenseGridAtAFractionOfItsTrials) {
  for (const double optimum : {1.2, 2.0, 3.3, 4.0, 5.5, 7.9, 13.0, 20.0})
    for (const int narrow : {32, 64, 256})
      for (const int broad : {64, 512}) {
        const Valley valley{optimum, narrow, broad};
        std::uint64_t calls = 0;
        Search search(
            wide_space(), {5, 21},
            [&](const SearchPoint& at, int samples) {
              std::vector<double> costs;
              for (int k = 0; k < samples; ++k) costs.push_back(valley(at) * noise(++calls));
              return costs;
            },
            never());
        search.walk();
        search.refine();
        search.decide();
        const std::vector<SearchPoint> grid = dense_grid(wide_space(), 1.05);
        EXPECT_LE(valley(search.best()->at), 1.10 * least_on(grid, valley)) << optimum << " " << narrow << " " << broad;
        EXPECT_LE(search.trials().size(), 40u);
        EXPECT_GE(grid.size(), 1300u);
        EXPECT_FALSE(search.cut());
      }
}

TEST(Search, ADenseGridHasItsEndsAndEveryLaunchShape) {
  const std::vector<SearchPoint> grid = dense_grid(wide_space(), 1.2);
  std::map<double, int> shapes;
  for (const SearchPoint& p : grid) ++shapes[p.cell];
  EXPECT_EQ(shapes.begin()->first, 1);
  EXPECT_EQ(shapes.rbegin()->first, 24);
  double before = 0;
  for (const auto& [cell, count] : shapes) {
    EXPECT_EQ(count, 20);
    if (before > 0) {
      EXPECT_LE(cell / before, 1.2 * (1 + 1e-12));
    }
    before = cell;
  }
  const SearchSpace nothing_to_choose;
  EXPECT_THAT(dense_grid(nothing_to_choose, 1.2), ::testing::ElementsAre(SearchPoint{}));
}

TEST(Search, RefusedPointsAreKeptWithTheirReasonAndNeverBest) {
  const Valley valley{16, 64, 256};  // the best of what is allowed lies at the wall
  Search search(
      wide_space(), {},
      [&](const SearchPoint& at, int samples) {
        if (at.cell > 9) throw InputError("too large a bucket");
        return std::vector<double>(samples, valley(at));
      },
      never());
  search.walk();
  search.refine();
  search.decide();
  EXPECT_GE(search.best()->at.cell, 8);
  EXPECT_LE(search.best()->at.cell, 9);
  int refused = 0;
  for (const Trial& t : search.trials())
    if (!t.refused.empty()) {
      ++refused;
      EXPECT_GT(t.at.cell, 9);
      EXPECT_EQ(t.refused, "too large a bucket");
      EXPECT_TRUE(std::isinf(t.cost()));
    }
  EXPECT_GE(refused, 2);
}

TEST(Search, WalksPastARefusedBeginning) {
  const Valley valley{11, 64, 256};
  Search search(
      wide_space(), {},
      [&](const SearchPoint& at, int samples) {
        if (at.cell < 10) throw InputError("too many cells");
        return std::vector<double>(samples, valley(at));
      },
      never());
  search.walk();
  ASSERT_NE(search.best(), nullptr);
  EXPECT_NEAR(search.best()->at.cell, 11.3, 0.1);
}

TEST(Search, WhereAllIsRefusedThereIsNoBest) {
  Search search(
      wide_space(), {}, [](const SearchPoint&, int) -> std::vector<double> { throw InputError("no memory"); }, never());
  search.walk();
  search.refine();
  search.decide();
  EXPECT_EQ(search.best(), nullptr);
  EXPECT_FALSE(search.trials().empty());
}

TEST(Search, ABudgetCutsItAfterAnyTrialButTheFirst) {
  const Valley valley{6, 64, 256};
  for (const std::size_t most : {0u, 1u, 2u, 5u, 12u, 20u}) {
    std::size_t tried = 0;
    Search search(
        wide_space(), {},
        [&](const SearchPoint& at, int samples) {
          ++tried;
          return std::vector<double>(samples, valley(at));
        },
        [&] { return tried >= most; });
    search.walk();
    search.refine();
    search.decide();
    EXPECT_TRUE(search.cut()) << most;
    EXPECT_EQ(search.trials().size(), std::max<std::size_t>(1, most));
    ASSERT_NE(search.best(), nullptr);
    double least = HUGE_VAL;
    for (const Trial& t : search.trials()) least = std::min(least, t.cost());
    EXPECT_EQ(search.best()->cost(), least);
  }
}

TEST(Search, ATimeThatWasLuckOnceDoesNotDecide) {
  bool lucky = true;
  Search search(
      {{4, 0, 128}, 4, 4, {}, {64, 128, 256}}, {},
      [&](const SearchPoint& at, int samples) {
        double cost = at.threads_narrow == 64 ? 100 : at.threads_narrow == 128 ? 110 : 115;
        if (at.threads_narrow == 256 && lucky) cost = 99, lucky = false;
        return std::vector<double>(samples, cost);
      },
      never());
  search.walk();
  search.refine();
  EXPECT_EQ(search.best()->at.threads_narrow, 256);
  search.decide();
  EXPECT_EQ(search.best()->at.threads_narrow, 64);
}

TEST(Search, ComparesByTheLowerQuartile) {
  EXPECT_EQ(search_cost({7}), 7);
  EXPECT_EQ(search_cost({9, 5, 8}), 5);
  EXPECT_EQ(search_cost({9, 8, 7, 6, 5, 4, 3, 2, 1}), 3);
  EXPECT_EQ(search_cost({2, 2, 2, 90, 90, 90, 90, 90, 90}), 2);  // preempted two times in three
}

// ---- the contest ----

std::vector<double> upto(int n) {
  std::vector<double> values;
  for (int k = n; k >= 1; --k) values.push_back(k);
  return values;
}

// Ranks as in tables of the sign test at 5 %, two sides.
TEST(Contest, IntervalsOfTheMedianAreOrderStatistics) {
  struct Row {
    int n, low;
  };
  for (const Row r : {Row{6, 1}, {8, 1}, {9, 2}, {11, 2}, {12, 3}, {15, 4}, {17, 5}, {20, 6}, {25, 8}}) {
    const Interval i = interval_of_rounds(upto(r.n));
    EXPECT_TRUE(i.known);
    EXPECT_EQ(i.low, r.low) << r.n;
    EXPECT_EQ(i.high, r.n + 1 - r.low) << r.n;
    EXPECT_EQ(i.middle, 0.5 * (r.n + 1)) << r.n;
  }
  EXPECT_FALSE(interval_of_rounds(upto(5)).known);
  EXPECT_THROW(interval_of_rounds({}), std::logic_error);
}

Standing standing(std::vector<double> rounds) {
  Standing s;
  s.rounds_us = std::move(rounds);
  return s;
}

TEST(Contest, ComparesWithinRounds) {
  // The machine slows down three times over; within each round one takes a tenth longer.
  const std::vector<double> slow = {11, 12, 14, 16, 18, 22, 26, 30, 33};
  std::vector<double> fast;
  for (const double t : slow) fast.push_back(t / 1.1);
  EXPECT_EQ(ratio_of(standing(slow), standing(fast)).verdict, "FASTER");
  EXPECT_NEAR(ratio_of(standing(slow), standing(fast)).interval.middle, 1.1, 1e-9);
  EXPECT_EQ(ratio_of(standing(fast), standing(slow)).verdict, "SLOWER");
  const Standing ten = standing(std::vector<double>(9, 10));
  EXPECT_EQ(ratio_of(standing({9.8, 10.2, 9.8, 10.2, 9.8, 10.2, 9.8, 10.2, 10}), ten).verdict, "SAME");
  EXPECT_EQ(ratio_of(standing({9, 11, 9, 11, 9, 11, 9, 11, 10}), ten).verdict, "UNSURE");  // 0.9 to 1.1: too noisy to tell
  EXPECT_EQ(ratio_of(standing(std::vector<double>(9, 10.2)), ten).verdict, "SAME");        // but for 2 %
  EXPECT_EQ(ratio_of(standing({20, 20}), standing({10, 10})).verdict, "UNSURE");
}

// ---- one detector on one packing ----

PackingContext loose(std::int32_t n, double cell_factor = 4) {
  PackingSpec spec;
  spec.kind = PackingKind::loose;
  spec.n = n;
  spec.cell_factor = cell_factor;
  spec.base_x = spec.base_y = 0;
  spec.solid_fraction = 0.4;
  const TemporaryFolder folder;
  return PackingContext(load_or_make(spec, folder.path()));
}

TEST(Tuner, NoTimeForAContactSetThatDiffers) {
  PackingContext context = loose(300);
  Reference wrong = context.reference();
  wrong.list.pairs.pop_back();
  wrong.contacts -= 1;
  Stream stream(Place::host);
  const DetectorInfo& info = find_detector("serial_multi_cell");
  EXPECT_THROW(tune(info, OutputForm::pairs, context.packing, context.facts, wrong, stream), Mismatch);
  EXPECT_NO_THROW(tune(info, OutputForm::pairs, context.packing, context.facts, context.reference(), stream));
}

TEST(Tuner, TuningsAreMultiplesOfWhatTheDetectorNeeds) {
  PackingContext context = loose(300);
  Stream stream(Place::host);
  const Tuning t = tune(find_detector("serial_multi_cell"), OutputForm::ball_lists, context.packing, context.facts,
                        context.reference(), stream);
  EXPECT_GE(t.cell_ravg, 1);
  EXPECT_EQ(t.cell_rmax, 0);
  EXPECT_THAT(t.tuned_on, HasSubstr(context.packing.name));
  DetectorInfo info = find_detector("serial_multi_cell");
  info.least_cell_rmax = 2;
  EXPECT_EQ(search_space(info, context.facts).first.cell, 2);
  const Tuning by_rmax = tuning_at(info, {2, 0, 0});
  EXPECT_EQ(cell_of(by_rmax, context.facts), 2.0 * context.facts.rmax);  // to the last bit: below it is refused
}

TEST(Tuner, RefusedCandidatesAreLoggedWithTheReason) {
  PackingContext context = loose(300);
  Stream stream(Place::host);
  DetectorInfo info = find_detector("serial_multi_cell");
  info.make = [](const PackingFacts& facts, const DetectorParams& params, Stream& s) {
    if (params.cell < 3 * facts.ravg) throw InputError("cells below 3 ravg are refused here");
    return find_detector("serial_multi_cell").make(facts, params, s);
  };
  std::vector<std::string> lines;
  const TuningTask task{info, OutputForm::pairs, Launch::stream, context.packing, context.facts, context.reference(), stream};
  Search search = make_search(task, never(), [&](const std::string& line) { lines.push_back(line); });
  search.walk();
  ASSERT_NE(search.best(), nullptr);
  EXPECT_GE(search.best()->at.cell, 3);
  EXPECT_THAT(lines, ::testing::Contains(HasSubstr("refused: cells below 3 ravg")));
}

// ---- a whole run ----

TEST(TuneRun, ABudgetTooShortStillAnswersAndSaysSo) {
  PackingContext context = loose(400);
  TuneOptions options;
  options.gpu = false;
  options.seconds = 1e-6;
  const TuneResult result = run_tune(options, context);
  EXPECT_TRUE(result.cut());
  EXPECT_EQ(result.rounds, 1);
  ASSERT_TRUE(result.tuned.front().chosen);
  for (const Tuned& t : result.tuned) EXPECT_EQ(t.trials.size(), 1u) << t.info->label();
  EXPECT_THAT(tune_text(result, context), HasSubstr("cut short"));
  EXPECT_THAT(tune_text(result, context), HasSubstr("UNSURE"));
  EXPECT_EQ(tune_json(result, context)["budget"]["cut"], true);
}

TEST(TuneRun, TheFastestComesFirstAndTheSearchIsSetBesideTheDenseGrid) {
  PackingContext context = loose(400);
  TuneOptions options;
  options.gpu = false;
  options.exhaustive = true;
  options.detectors = "serial";
  const TuneResult result = run_tune(options, context);
  EXPECT_FALSE(result.cut());
  EXPECT_EQ(result.rounds, kContestRounds);
  ASSERT_EQ(result.tuned.size(), 2u);
  EXPECT_LE(result.standing(result.tuned[0]).median_us(), result.standing(result.tuned[1]).median_us());
  EXPECT_EQ(result.paper_at_rule()->info->name, "serial_multi_cell");
  EXPECT_DOUBLE_EQ(result.paper_at_rule()->asked.cell, 2 * context.facts.ravg);
  const Json j = tune_json(result, context);
  for (const Json& d : j["detectors"]) {
    ASSERT_EQ(d["contest"]["rounds_us"].size(), std::size_t{kContestRounds});
    EXPECT_GT(d["contest"]["bytes"], 16 * 400);
    if (d["detector"] != "serial_multi_cell") continue;
    EXPECT_GE(d["exhaustive"]["candidates"].size(), 25u);
    EXPECT_GT(d["exhaustive"]["search_over_exhaustive"]["ratio"], 0);
  }
  EXPECT_THAT(exhaustive_text(result, context), HasSubstr("serial_multi_cell"));
}

TEST(TuneRun, WhatCannotTakePartIsLeftOutWithAWord) {
  PackingContext context = loose(kMostBallsAllPairs + 1);
  TuneOptions options;
  options.gpu = false;
  options.seconds = 0.5;
  options.detectors = "all_pairs|serial_levels";
  const TuneResult result = run_tune(options, context);
  ASSERT_EQ(result.left_out.size(), 1u);
  EXPECT_EQ(result.left_out[0].first, "all_pairs");
  EXPECT_THAT(tune_text(result, context), HasSubstr("left out"));
  options.detectors = "no_such";
  EXPECT_THROW(run_tune(options, context), InputError);
  options.detectors = "[";
  EXPECT_THROW(run_tune(options, context), InputError);
}

// ---- the file ----

class TuneFile : public ::testing::Test {
 protected:
  TuneFile() : context_(loose(400)) {
    TuneOptions options;
    options.gpu = false;
    options.output = OutputForm::ball_lists;
    options.detectors = "serial_multi_cell";
    options.seconds = 2;
    result_ = run_tune(options, context_);
    file_ = tune_json(result_, context_);
  }
  std::filesystem::path written(const std::string& text) {
    const std::filesystem::path path = folder_.path() / "tuned.json";
    testing::write_text(path, text);
    return path;
  }
  std::string fault(const std::string& text) {
    try {
      read_tune_config(written(text));
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), HasSubstr("tuned.json"));
      EXPECT_THAT(e.what(), Not(HasSubstr("\n")));
      return e.what();
    }
    return "";
  }
  TemporaryFolder folder_;
  PackingContext context_;
  TuneResult result_;
  Json file_;
};

TEST_F(TuneFile, ComesBackAsWritten) {
  result_.tuned[0].chosen->cell = 10.0 / 3;  // no float and no short decimal, whatever was found
  file_ = tune_json(result_, context_);
  testing::parse_strictly(file_.dump());
  const TuneConfig c = read_tune_config(written(file_.dump(2)));
  EXPECT_EQ(c.detector, "serial_multi_cell");
  EXPECT_EQ(c.place, "cpu");
  EXPECT_EQ(c.device, tuned_device(Place::host));
  EXPECT_EQ(c.output, OutputForm::ball_lists);
  EXPECT_EQ(c.n, 400);
  EXPECT_EQ(c.tuning.cell_ravg, result_.tuned[0].chosen->cell);  // to the last bit
  EXPECT_EQ(c.tuning.cell_rmax, 0);
  EXPECT_EQ(c.tuning.threads_narrow, 0);
  EXPECT_NO_THROW(require_fit(c, find_detector(c.detector), "f"));
  EXPECT_THAT(differences(c, context_.facts), ::testing::IsEmpty());
}

TEST_F(TuneFile, AnotherPackingIsToldApart) {
  const TuneConfig c = read_tune_config(written(file_.dump()));
  PackingFacts other = context_.facts;
  other.rmax *= 1.5f;
  other.n *= 3;
  const std::vector<std::string> found = differences(c, other);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_THAT(found[0], HasSubstr("rmax"));
  EXPECT_THAT(found[1], HasSubstr("1200 balls, tuned on 400"));
  other = context_.facts;
  other.ravg *= 1.5;
  EXPECT_DOUBLE_EQ(cell_of(c.tuning, other), 1.5 * cell_of(c.tuning, context_.facts));  // scales with ravg
}

TEST_F(TuneFile, EveryDamageIsOneLineThatNamesIt) {
  EXPECT_THAT(fault(""), HasSubstr("no JSON"));
  EXPECT_THAT(fault(file_.dump().substr(0, 300)), HasSubstr("no JSON"));
  EXPECT_THAT(fault("[]"), HasSubstr("not an object"));
  EXPECT_THAT(fault("{}"), HasSubstr("schema"));
  struct Damage {
    const char *place, *key;
    Json value;
  };
  for (const Damage& d : {Damage{"", "schema", "touchstone/1"},
                          {"", "choice", 7},
                          {"", "packing", nullptr},
                          {"choice", "detector", 3},
                          {"choice", "place", "moon"},
                          {"choice", "output", "csr"},
                          {"choice", "launch", "batch"},
                          {"choice", "cell_ravg", -1},
                          {"choice", "cell_ravg", "4"},
                          {"choice", "cell_rmax", 2},
                          {"choice", "threads_broad", 0},
                          {"choice", "threads_narrow", 12.5},
                          {"choice", "threads_narrow", 4096},
                          {"packing", "n", 0},
                          {"packing", "n", 1e300},
                          {"packing", "ravg_cm", nullptr}}) {
    Json damaged = file_;
    (*d.place ? damaged[d.place] : damaged)[d.key] = d.value;
    EXPECT_THAT(fault(damaged.dump()), HasSubstr(d.key)) << d.place << " " << d.key << " " << d.value;
    damaged = file_;
    (*d.place ? damaged[d.place] : damaged).erase(d.key);
    EXPECT_THAT(fault(damaged.dump()), HasSubstr(d.key)) << "without " << d.key;
  }
}

TEST_F(TuneFile, AChoiceMustFitItsDetector) {
  TuneConfig c = read_tune_config(written(file_.dump()));
  const DetectorInfo& info = find_detector("serial_multi_cell");
  c.tuning.cell_ravg = 0;
  EXPECT_THROW(require_fit(c, info, "f"), InputError);  // needs a cell
  c.tuning.cell_ravg = 4;
  EXPECT_NO_THROW(require_fit(c, info, "f"));
  EXPECT_THROW(require_fit(c, find_detector("serial_levels"), "f"), InputError);  // takes none
  c.tuning.threads_narrow = 64;
  EXPECT_THROW(require_fit(c, info, "f"), InputError);
}

// ---- the programs ----

class TuneProgram : public ::testing::Test {
 protected:
  Outcome touchstone(const std::string& arguments) {
    return run_program("TOUCHSTONE_PACKINGS=" + (folder_.path() / "packings").string() + " " TOUCHSTONE " " + arguments);
  }
  std::string file(const char* name) const { return (folder_.path() / name).string(); }
  TemporaryFolder folder_;
};

TEST_F(TuneProgram, TunesAndDetectReadsTheAnswer) {
  const std::string spec = "--spec n=2969,c=4,kind=loose,base=cube,phi=0.5";
  const Outcome tuned = touchstone("tune --place cpu --detectors 'multi_cell|serial_levels' --seconds 2 --verbose " + spec +
                                   " --out " + file("t.json"));
  ASSERT_EQ(tuned.code, 0) << tuned.err;
  EXPECT_THAT(tuned.out, HasSubstr("fastest"));
  EXPECT_THAT(tuned.out, HasSubstr("over next"));
  EXPECT_THAT(tuned.out, HasSubstr("of equation 3"));
  EXPECT_THAT(tuned.err, HasSubstr("serial_multi_cell pairs, cell 4 ravg"));
  const auto j = testing::parse_strictly(testing::file_text(file("t.json")));
  EXPECT_EQ(j["schema"], "touchstone-tune/1");

  // Its own choice would be 8 ravg; 3.5 ravg can only come from the file.
  auto edited = j;
  edited["choice"]["detector"] = "serial_multi_cell";
  edited["choice"]["cell_ravg"] = 3.5;
  testing::write_text(file("t.json"), edited.dump());
  const Outcome same = touchstone("detect " + spec + " --config " + file("t.json"));
  ASSERT_EQ(same.code, 0) << same.err;
  EXPECT_THAT(same.out, HasSubstr("\nserial_multi_cell "));
  EXPECT_THAT(same.out, HasSubstr("\ncell                       0.967 cm"));  // 3.5 times 0.27629 cm
  EXPECT_THAT(same.err, Not(HasSubstr("note:")));

  const Outcome other =
      touchstone("detect --output ball_lists --spec n=500,c=2,kind=loose,base=cube,phi=0.5 --config " + file("t.json"));
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_THAT(other.err, HasSubstr("note: rmax"));
  EXPECT_THAT(other.err, HasSubstr("note: 500 balls"));
  EXPECT_THAT(other.err, HasSubstr("note: output ball_lists, tuned for pairs"));
}

TEST_F(TuneProgram, DetectLeavesToTheDetectorWhatIsNotGiven) {
  const std::string detect = "detect --spec n=300,c=1,kind=loose,base=cube,phi=0.3 --detector serial_multi_cell";
  EXPECT_THAT(touchstone(detect).out, HasSubstr("\ncell                       2 cm"));  // 8 ravg, not equation 3's 2
  EXPECT_THAT(touchstone(detect + " --cell-cm 0.7").out, HasSubstr("\ncell                       0.7 cm"));
}

TEST_F(TuneProgram, WhatItRefuses) {
  struct Row {
    std::string arguments;
    int code;
    std::string words;
  };
  const std::string spec = "--spec n=300,c=4,kind=loose,base=cube,phi=0.5 ";
  testing::write_text(file("bad.json"), "{\"schema\": \"touchstone/1\"}");
  for (const Row& r : {Row{"tune", 2, "either --packing FILE or --spec"},
                       {"tune " + spec + "--output csr", 2, "--output 'csr': pairs or ball_lists"},
                       {"tune " + spec + "--launch batch", 2, "--launch 'batch'"},
                       {"tune " + spec + "--place moon", 2, "--place 'moon'"},
                       {"tune " + spec + "--seconds 0", 2, "--seconds 0"},
                       {"tune " + spec + "--detectors '['", 2, "no regular expression"},
                       {"tune " + spec + "--detectors nothing", 2, "no detector to tune"},
                       {"tune " + spec + "--out " + folder_.path().string(), 2, "a folder, not a file"},
                       {"tune --packing " + file("absent.xyz"), 2, "absent.xyz"},
                       {"detect " + spec + "--config " + file("absent.json"), 2, "absent.json"},
                       {"detect " + spec + "--config " + file("bad.json"), 2, "touchstone-tune/1"},
                       {"detect " + spec + "--config " + file("bad.json") + " --cell-cm 1", 2, "excludes"}}) {
    const Outcome o = touchstone(r.arguments);
    EXPECT_EQ(o.code, r.code) << r.arguments << "\n" << o.err;
    EXPECT_THAT(o.err, HasSubstr(r.words)) << r.arguments;
  }
  if (!gpu_usable()) {
    EXPECT_EQ(touchstone("tune --place gpu " + spec).code, 5);
  }
}

}  // namespace
}  // namespace touchstone
