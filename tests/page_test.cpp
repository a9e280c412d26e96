// The page as a browser sees it: nothing wider than a phone, nothing without a size, no dead link, nothing on the console. Where
// there is no chromium the browser's part is skipped. All numbers come from fixtures: not measured.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <memory>
#include <regex>
#include <set>
#include <sstream>

#include "tests/fixtures/report_fixtures.h"
#include "tests/run_program.h"

namespace touchstone::testing {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

const std::filesystem::path kSource = TOUCHSTONE_SOURCE_DIR;

// Added to a copy of the page only: measures, and tells the page around it.
constexpr const char* kProbe = R"(<script>
addEventListener('load', () => {
  const wide = [...document.querySelectorAll('body *')].filter(e => !e.closest('.scroll') && !e.closest('svg') &&
    e.getBoundingClientRect().right > innerWidth + 1).map(e => e.tagName + '.' + e.className);
  const figures = [...document.querySelectorAll('svg, img')].map(e => e.getBoundingClientRect());
  const text = [...document.querySelectorAll('svg text')].map(e => e.getBoundingClientRect().height).filter(h => h > 0);
  parent.postMessage({width: innerWidth, page: document.documentElement.scrollWidth, wide, figures: figures.length,
    empty: figures.filter(r => !(r.width > 0 && r.height > 0)).length, least_text: Math.min(...text)}, '*');
});
</script></body>)";

// A frame of a given width, since no window is narrower than 500 px; writes what it is told where --dump-dom shows it.
constexpr const char* kFrame = R"(<!DOCTYPE html><meta charset="utf-8"><pre id="probe"></pre><script>
addEventListener('message', e => { document.getElementById('probe').textContent = 'PROBE ' + JSON.stringify(e.data) + ' END'; });
</script><iframe src="probe.html" style="border:0;height:900px;width:)";

std::string browser() {
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"})
    if (run_program(std::string("command -v ") + name).code == 0) return name;
  return "";
}

std::vector<std::string> all_matches(const std::string& text, const std::string& pattern) {
  const std::regex expression(pattern);
  std::vector<std::string> list;
  for (std::sregex_iterator at(text.begin(), text.end(), expression), end; at != end; ++at) list.push_back((*at)[1]);
  return list;
}

// One report for all tests of this file: drawing it takes seconds.
class Page : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    fixtures::write_all(kSource, folder_->path() / "results");
    made_ = report("a");
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static Outcome report(const std::string& out) {
    return run_program(std::string(TOUCHSTONE) + " report --results " + (folder_->path() / "results").string() + " --out " +
                       (folder_->path() / out).string());
  }
  void SetUp() override { ASSERT_EQ(made_.code, 0) << made_.err; }
  static std::filesystem::path out() { return folder_->path() / "a"; }
  static std::string page() { return file_text(out() / "index.html"); }

  // What the probe measured in a window of this width.
  static json probe(const std::string& program, int width, std::string* console) {
    std::string text = page();
    text.replace(text.rfind("</body>"), 7, kProbe);
    write_text(out() / "probe.html", text);
    write_text(out() / "frame.html", kFrame + std::to_string(width) + "px\"></iframe>");
    // A profile of its own, and no sandbox: in a container, and as root, chromium has none.
    const Outcome o =
        run_program("HOME=" + folder_->path().string() + " " + program +
                    " --headless --no-sandbox --disable-gpu --disable-dev-shm-usage --hide-scrollbars"
                    " --enable-logging=stderr --virtual-time-budget=5000 --window-size=1400,1000 --dump-dom file://" +
                    (out() / "frame.html").string());
    std::filesystem::remove(out() / "frame.html");
    std::filesystem::remove(out() / "probe.html");
    *console = "";
    std::istringstream lines(o.err);
    for (std::string line; std::getline(lines, line);)
      if (line.find("CONSOLE") != std::string::npos) *console += line + "\n";
    const std::size_t begin = o.out.rfind("PROBE {"), end = o.out.rfind("} END");
    if (begin == std::string::npos || end == std::string::npos) {
      ADD_FAILURE() << program << " gave no measurement (exit " << o.code << "): " << o.err;
      return json::object();
    }
    return json::parse(o.out.substr(begin + 6, end + 1 - begin - 6));
  }

  static std::unique_ptr<TemporaryFolder> folder_;
  static Outcome made_;
};
std::unique_ptr<TemporaryFolder> Page::folder_;
Outcome Page::made_;

TEST_F(Page, InABrowserFitsAPhoneAndADesk) {
  const std::string program = browser();
  if (program.empty()) GTEST_SKIP() << "no chromium here: the page was not opened in a browser";
  for (const int width : {360, 1280}) {
    std::string console;
    const json seen = probe(program, width, &console);
    if (seen.empty()) continue;
    EXPECT_EQ(seen["width"], width) << "the browser did not take the window's width";
    EXPECT_LE(seen["page"], width) << seen["wide"];
    EXPECT_THAT(seen["wide"], IsEmpty()) << "wider than a window of " << width;
    EXPECT_GE(seen["figures"].get<int>(), 34) << "figure 8: 2; 6 and 7: 1 each; 9: 3; cards: 3; equations: 1; fairness: 6; "
                                                 "trajectory: 4; updates: 2; spread: 3; scale: 6; hostile: 2";
    EXPECT_EQ(seen["empty"], 0) << "figures without a size at " << width;
    EXPECT_GE(seen["least_text"].get<double>(), 8) << "a figure's text, px, at " << width;
    EXPECT_THAT(console, IsEmpty());
  }
}

TEST_F(Page, NeedsNothingFromElsewhere) {
  const std::string text = page();
  EXPECT_THAT(text, Not(HasSubstr("<script")));
  EXPECT_THAT(text, Not(HasSubstr("@import")));
  for (const char* where : {"(?:src|href)=[\"']([^\"']*)[\"']", "url\\(([^)]*)\\)"})
    for (const std::string& address : all_matches(text, where))
      EXPECT_THAT(address, Not(HasSubstr("//"))) << "an address of another machine";
}

TEST_F(Page, EveryLinkLeadsToAFileOrAPlaceInThePage) {
  const std::string text = page();
  std::set<std::string> ids;
  for (const std::string& id : all_matches(text, " id=[\"']([^\"']*)[\"']"))
    EXPECT_TRUE(ids.insert(id).second) << id << " is given twice";
  const auto links = all_matches(text, "href=[\"']([^\"']*)[\"']");
  EXPECT_GE(links.size(), 80u);
  for (const std::string& link : links) {
    if (link == "data:,") continue;
    if (link[0] == '#')
      EXPECT_EQ(ids.count(link.substr(1)), 1u) << link;
    else
      EXPECT_TRUE(std::filesystem::is_regular_file(out() / link)) << link;
  }
}

TEST_F(Page, HoldsEveryTableAndFigure) {
  const std::string text = page();
  for (const std::string id : {"table1",
                               "table2",
                               "table2_best_fixture-1",
                               "table2_rule_fixture-1",
                               "figure8",
                               "figure6_fixture-1",
                               "figure7_fixture-1",
                               "optima_figure6_fixture-1",
                               "optima_equations_fixture-1",
                               "figure9_fixture-1_1",
                               "table3",
                               "ablation_fixture-1",
                               "cases_fairness_fixture-1",
                               "devices",
                               "runs",
                               "generations",
                               "cards",
                               "theory_figure6_fixture-1",
                               "theory_figure7_fixture-1",
                               "equations_fixture-1",
                               "residuals_fixture-1",
                               "fairness_fixture-1",
                               "fairness_seeds_fixture-1",
                               "fairness_order_fixture-1",
                               "fairness_knowledge_fixture-1",
                               "fairness_cache_fixture-1",
                               "fairness_force_fixture-1",
                               "fairness_output_fixture-1",
                               "fairness_shape_fixture-1",
                               "fairness_radii_fixture-1",
                               "fairness_bytes_fixture-1",
                               "scale_fixture-1_c1",
                               "scale_fixture-1_c4",
                               "scale_speed_fixture-1",
                               "scale_bytes_fixture-1",
                               "cases_scale_fixture-1",
                               "trajectory_c4_n2969_fixture-1",
                               "trajectory_c4_n2969_fixture-1_figure",
                               "cases_trajectory_fixture-1",
                               "updates_c4_n2969_fixture-1",
                               "updates_c4_n2969_fixture-1_figure",
                               "hostile_fixture-1",
                               "hostile_table_fixture-1",
                               "polydispersity_fixture-1",
                               "polydispersity_table_fixture-1"})
    EXPECT_THAT(text, HasSubstr(" id=\"" + id + "\"")) << id;
  EXPECT_THAT(text, Not(HasSubstr("Not measured yet")));
  EXPECT_THAT(text, HasSubstr("bench_detect --study figure6 --profile full"));
  EXPECT_THAT(text, HasSubstr("nothing was timed"));  // the record's own words for the timed region
}

TEST(CommittedReport, HoldsTheLedgerOfClaimsAndAgreesWithIt) {
  const TemporaryFolder folder;
  const Outcome o = run_program(std::string(TOUCHSTONE) + " report --results " + (kSource / "results").string() + " --out " +
                                folder.path().string());
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(file_text(folder.path() / "index.html"), HasSubstr("href=\"claims.json\""));
  const json ledger = json::parse(file_text(folder.path() / "claims.json"));
  // The residuals beside the figure of the equations are the ledger's: two ways to read the same records.
  int compared = 0;
  for (const json& claim : ledger.at("claims"))
    for (const json& rule : claim.at("id") == "optimum-follows-ravg" ? claim.at("rules") : json::array())
      for (const json& finding : rule.at("findings")) {
        if (!finding.contains("threshold") || rule.at("name") != "GPU, against spacing") continue;
        const std::string table = file_text(folder.path() / ("residuals_" + finding.at("device").get<std::string>() + ".csv"));
        const auto here = all_matches(table, "\nmulti_cell_bucket/paper,\\(V/N[^\n]*,(0\\.[0-9]+),[^,\n]*(?:,[^,\n]*)?\n");
        ASSERT_EQ(here.size(), 1u) << table;
        EXPECT_NEAR(std::stod(here[0]), finding.at("threshold")[0].at("value").get<double>(), 5e-4);
        ++compared;
      }
  EXPECT_GE(compared, 1);
}

TEST_F(Page, EscapesWhatRecordsSay) {
  const std::string text = page();
  EXPECT_THAT(text, HasSubstr("none &lt;of&gt; &quot;these&quot; &amp; &#39;those&#39;"));
  EXPECT_THAT(text, Not(HasSubstr("none <of>")));
}

TEST_F(Page, FlagsTravelAsMarks) {
  EXPECT_THAT(file_text(out() / "cases_figure6_fixture-1.csv"), HasSubstr("†,"));
  EXPECT_THAT(file_text(out() / "table2_best_fixture-1.md"), HasSubstr("† noise: "));
  EXPECT_THAT(file_text(out() / "table2_best_fixture-1.md"), HasSubstr("every row: virtual_machine."));
  EXPECT_THAT(file_text(out() / "table2_best_fixture-1.tex"), HasSubstr("\\dag{}"));
  EXPECT_THAT(file_text(out() / "figure6_fixture-1_multi_cell_bucket-paper-ball_lists-stream-hot-shuffled.svg"), HasSubstr("†"));
}

TEST_F(Page, TheSweepsOptimumAndEnvelopeFollowFromTheRecords) {
  // Least at 4 ravg = 1.0 cm for C = 1 and 4 x 0.29375 for C = 6, of cells 0.125 apart.
  const std::string optima = file_text(out() / "optima_figure6_fixture-1.csv");
  EXPECT_THAT(optima, HasSubstr("c1_n50000,0.25,0.25,0.25,1,1 to 1,4,4 to 4,0.0660\n"));
  EXPECT_THAT(optima, HasSubstr("c6_n50000,0.25,0.2938,1.5,1.125,1.12 to 1.25,3.83,3.83 to 4.26,0.0964\n"));
  const std::string settings = file_text(out() / "figure6_fixture-1_multi_cell_bucket-paper-ball_lists-stream-hot-shuffled.gp");
  // 11,200 / h^3 cells: above 65,535 up to 0.5 cm. 2 + 56 h^3 / C balls, rounded down: above 128 from 1.375 cm (C = 1) and 2.5 cm
  // (C = 6) on. Edges halfway.
  EXPECT_THAT(settings, HasSubstr("left_all = 0.5625\nleft_any = 0.5625\nright_any = 1.3125\nright_all = 2.4375\n"));
  const std::string cpu = file_text(out() / "figure7_fixture-1_serial_multi_cell-ball_lists-hot-shuffled.gp");
  EXPECT_THAT(cpu, HasSubstr("left_all = NaN\nleft_any = NaN\nright_any = NaN\nright_all = NaN\n"));
}

TEST_F(Page, TheThreadMapMarksTheBestAndWhatIsAsGood) {
  const std::string data = file_text(out() / "figure9_fixture-1_1_map.dat");
  EXPECT_THAT(data, HasSubstr("# best\n3 2\n"));
  EXPECT_THAT(data, HasSubstr("# as good\n3 3\n"));
  EXPECT_THAT(data, HasSubstr("0 4 NaN \"refused\"\n"));
}

TEST_F(Page, AblationsStandBesideTheSameCaseUnchanged) {
  const std::string table = file_text(out() / "ablation_fixture-1.md");
  EXPECT_THAT(table, HasSubstr("| judge_off | c4_n48928 | ball_lists | 0.0900 | 0.0600 | 1.50× |"));
  EXPECT_THAT(table, HasSubstr("| not measured: a bucket overflowed past what fits |"));
}

TEST_F(Page, TheLengthThatTheBestCellFollowsHasTheLeastResidual) {
  // The fixture's best cell is 4 ravg, but for the steps of its sweep.
  const std::string table = file_text(out() / "residuals_fixture-1.csv");
  const auto rows = all_matches(table, "\n(multi_cell_bucket/paper,[^\n]*)");
  ASSERT_EQ(rows.size(), 4u) << table;
  const auto cells = [](const std::string& line) { return all_matches(line, "([^,]+)"); };
  EXPECT_EQ(cells(rows[1])[1], "ravg");
  EXPECT_NEAR(std::stod(cells(rows[1])[3]), 4, 0.1);
  double low = 0, high = 0;  // of the packings' scatter, which the fixture has only from its steps: a few per cent
  ASSERT_EQ(std::sscanf(cells(rows[1])[4].c_str(), "%lf to %lf", &low, &high), 2) << rows[1];
  EXPECT_GT(low, 3.8);
  EXPECT_LT(high, 4.2);
  EXPECT_EQ(cells(rows[1])[6], low <= 4 && 4 <= high ? "yes" : "no") << rows[1];
  EXPECT_EQ(cells(rows[1]).back(), " the least\"");
  EXPECT_LT(std::stod(cells(rows[1])[7]), std::stod(cells(rows[0])[7]));
  EXPECT_THAT(file_text(out() / "residuals_fixture-1.md"), HasSubstr("ravg explains the best cell best"));
  const std::string settings = file_text(out() / "equations_fixture-1_1.gp");
  EXPECT_THAT(settings, HasSubstr("least_at = 2\n"));
  EXPECT_THAT(settings, HasSubstr("paper_factor = 4\n"));
}

TEST_F(Page, TimesAreSetAgainstWhatTheCardsCouldHaveDone) {
  const std::string table = file_text(out() / "generations.csv");
  EXPECT_THAT(table, HasSubstr("\nGTX 285 (published),ms,0.50,"));
  // 0.50 ms x 100 GB/s over 2,969 balls: 16.8 kB a ball; half of it as read with a card of half the bandwidth.
  EXPECT_THAT(table, HasSubstr("\nGTX 285 (published),\"time x bandwidth, kB a ball\",16.8,"));
  EXPECT_THAT(table, HasSubstr("\nGTX 285 read as GTX 280 (published),\"time x bandwidth, kB a ball\",8.42,"));
  // 500 cores x 1 GHz x 2.
  EXPECT_THAT(table, HasSubstr("\nGTX 580 (published),\"time x FP32, kFLOP a ball\",74.1,"));
  // 170.063 us x the record's 1000 GB/s over 140,063 balls.
  EXPECT_THAT(all_matches(table, "Fixture, paper's method\",\"time x bandwidth, kB a ball\",([^\n]*)"),
              ::testing::ElementsAre("11.1,not measured,not measured,not measured,not measured,not measured,1.21"));
  EXPECT_THAT(file_text(out() / "cards.md"), HasSubstr("| Fixture | 990 | 1000 (1.0 % off) |"));
}

TEST_F(Page, FairnessIsReadFromTheRatios) {
  const auto has = [&](const std::string& question, const std::string& words) {
    EXPECT_THAT(file_text(out() / ("fairness_" + question + "_fixture-1.md")), HasSubstr(words));
  };
  has("order", "| sorted_grid/rows | ball_lists | 0.500× (0.490 to 0.510) | 1.00× (0.985 to 1.03) |");
  has("order",
      "sorted / shuffled: 0.500× (sorted_grid/rows, ball_lists) to 0.500× (serial_levels, pairs), median 0.500×; 4 of 4 told "
      "apart from 1.");
  has("order", "median 1.00×; 0 of 4 told apart from 1.");
  has("knowledge", "blind / known: 1.50× (serial_levels, ball_lists) to 3.00× (sorted_grid/rows, pairs), median 2.25×");
  has("cache", "| sorted_grid/rows | pairs | 1.10× (1.08 to 1.12) | 0.900× (0.882 to 0.918) |\n\n");  // and no CPU row
  has("force", "| serial_levels | pairs | 1.20× (1.18 to 1.22) |");
  has("output", "| sorted_grid/rows | 1.00× (0.980 to 1.02) | 1.00× (0.980 to 1.02) |");
  has("seeds", "| sorted_grid/rows | ball_lists | 0.0220 | 0.909 | 1.09 | 18.2 % | nothing to tune |");
  has("shape", "| 0.250× (0.245 to 0.255) | 1.00 | 0.50 |");
  has("radii", "| sorted_grid/rows | pairs | 0.100 | 2.00× (1.96 to 2.04) |");
  has("bytes", "| sorted_grid/rows | pairs | 200 |");
}

TEST_F(Page, ScaleStandsBesideItsFloorsAndSaysWhatIsLeftOut) {
  const std::string speed = file_text(out() / "scale_speed_fixture-1.md"), bytes = file_text(out() / "scale_bytes_fixture-1.md");
  // 10^6 balls in 206 us, 520 us and 200 ms.
  EXPECT_THAT(speed, HasSubstr("| c1_n50000_tiled1000000 | shuffled | 4.85 | 0.980 | 0.00500 |"));
  EXPECT_THAT(speed, HasSubstr("| c1_n50000_tiled1000000000 | sorted | 10.0"));
  EXPECT_THAT(speed, HasSubstr("| no: memory | no: time |"));
  EXPECT_THAT(speed, HasSubstr("memory: sorted_grid/rows needs more bytes than are free"));
  EXPECT_THAT(speed, HasSubstr("| c4_n2969 | shuffled | 0.330 | – | – |"));
  EXPECT_THAT(bytes, HasSubstr("| 68 (80) |")) << "16 in, 28 of workspace, 3 contacts of 8";
  const std::string data = file_text(out() / "scale_fixture-1_c1_shuffled.dat");
  // An empty launch of 5 us; 40 bytes a ball at 800 GB/s. Nanoseconds a ball.
  EXPECT_THAT(data, HasSubstr("# floor: an empty launch\n1000 5 NaN"));
  EXPECT_THAT(data, HasSubstr("\n1e+09 5e-06 NaN"));
  EXPECT_THAT(data, HasSubstr("# floor: bytes in and out\n1000 0.05 NaN"));
  EXPECT_THAT(data, HasSubstr("# levels/x\n1000 6.2 "));
  EXPECT_THAT(file_text(out() / "scale_fixture-1_c1_sorted.dat"), Not(HasSubstr("\n1000 "))) << "orders matter from 10^6 on";
  EXPECT_THAT(file_text(out() / "scale_fixture-1_c4_bytes.dat"), HasSubstr("1e+09 68 "));
}

// A machine without a GPU has no calibration: no floor is made up.
TEST_F(Page, ScaleWithoutACalibrationHasNoFloors) {
  const std::filesystem::path file = folder_->path() / "results/fixture-1/scale.json", aside = folder_->path() / "scale.json";
  std::filesystem::rename(file, aside);
  json cpu = json::parse(file_text(aside));
  cpu["context"]["touchstone"]["calibration"] = nullptr;
  write_text(file, cpu.dump());
  const Outcome o = report("d");
  std::filesystem::remove(file);
  std::filesystem::rename(aside, file);
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(file_text(folder_->path() / "d/scale_fixture-1_c1_shuffled.dat"), Not(HasSubstr("floor")));
  EXPECT_THAT(file_text(folder_->path() / "d/scale_fixture-1_c1_shuffled.gp"),
              HasSubstr("quartiles_from = 1\ny_low = 0.100003\n"));
}

TEST_F(Page, TheSpreadOfRadiiStandsBesideEqualBallsAndItsBar) {
  const std::string table = file_text(out() / "polydispersity_table_fixture-1.md");
  // 50 us over 50,000 balls is 1 ns, times the square root of 1.5 at C = 10; C = 1 stands in every mixture's row.
  EXPECT_THAT(table, HasSubstr("| power law, r^-3 | 50,000 | levels | 1.00 | 1.22 | 1.50 | 1.50×, bar met |"));
  EXPECT_THAT(table,
              HasSubstr("| uniform in radius | 50,000 | serial_levels | 180 | 220 | not measured: made up: too large | – |"));
  const std::string settings = file_text(out() / "polydispersity_fixture-1_uniform_loose_50000.gp");
  EXPECT_THAT(settings, HasSubstr("bar = 2\n"));
  EXPECT_THAT(file_text(out() / "polydispersity_fixture-1_uniform_loose_50000.dat"), HasSubstr("1 1 0.99 1.01 \"\"\n10 1.22474"));
}

TEST(SpreadOfRadii, SaysThatTheBarIsMissed) {
  const TemporaryFolder folder;
  fixtures::write_all(kSource, folder.path() / "results");
  write_text(folder.path() / "results/fixture-1/polydispersity.json", fixtures::polydispersity(2.5).dump());
  const Outcome o = run_program(std::string(TOUCHSTONE) + " report --results " + (folder.path() / "results").string() +
                                " --out " + (folder.path() / "out").string());
  ASSERT_EQ(o.code, 0) << o.err;
  EXPECT_THAT(file_text(folder.path() / "out/polydispersity_table_fixture-1.md"), HasSubstr("| 2.50×, bar missed |"));
}

TEST_F(Page, TheTheoryLineNamesItsFloorsAndABadFit) {
  const std::string settings = file_text(out() / "figure6_fixture-1_multi_cell_bucket-paper-ball_lists-stream-hot-shuffled.gp");
  EXPECT_THAT(settings, HasSubstr("curves = 6\nlaunch_floor = 0.005\nbytes_floor = 0.00275\n"));  // 2.2 MB at 800 GB/s
  EXPECT_THAT(settings, HasSubstr("theory, C = 1"));
  EXPECT_THAT(settings, Not(HasSubstr("theory, C = 3")));
  EXPECT_THAT(file_text(out() / "figure7_fixture-1_serial_multi_cell-ball_lists-hot-shuffled.gp"),
              HasSubstr("launch_floor = NaN\nbytes_floor = NaN\n"));
  EXPECT_THAT(page(),
              HasSubstr("the fit is bad (root mean square off by more than 10 %): C = 1 "));  // its curves are no two-term costs
}

TEST_F(Page, ATrajectorysMeanStandsBesideTheBedAtRest) {
  // Eleven frames from 20 to 40 us, on average 30; at rest 32 us. The GPU's list was too small from frame 70 on.
  const std::string table = file_text(out() / "trajectory_c4_n2969_fixture-1.csv");
  EXPECT_THAT(table, HasSubstr("sorted_grid/rows,0.0300†,0.0320,0.938× (0.919 to 0.956),0.0200 (at 0),0.0400 (at 100),"));
  EXPECT_THAT(table, HasSubstr(",1.25× (1.23 to 1.28),4 of 11 (list; first at 70),100 to 120"));
  EXPECT_THAT(table, HasSubstr("serial_levels,1.35,1.44,0.938×"));
  EXPECT_THAT(table, HasSubstr(",none,100 to 100"));
  const std::string curve = file_text(out() / "trajectory_c4_n2969_fixture-1_gpu.dat");
  EXPECT_THAT(curve, HasSubstr("30 0.026 0.02574 0.02626 \"†\""));
  EXPECT_THAT(curve, HasSubstr("70 0.034 0.03366 0.03434 \"↑\""));
  EXPECT_THAT(curve, HasSubstr("# at rest\n106 0.032"));
  EXPECT_THAT(file_text(out() / "trajectory_c4_n2969_fixture-1_memory.dat"), HasSubstr("60 100 100 100 \"\"\n70 120"));
}

TEST_F(Page, AnUpdateStandsBesideDetectOfTheSameBalls) {
  const std::string table = file_text(out() / "updates_c4_n2969_fixture-1.csv");
  EXPECT_THAT(table, HasSubstr("sorted_grid/rows,not at all,0,0,\"9,000\",0.0160,0.0320,0.500× (0.464 to 0.537)"));
  EXPECT_THAT(table, HasSubstr("sorted_grid/rows,each ball 0.1 rmin,0.1,0.1,\"9,000\",0.0160,0.0320,0.500×"));
  EXPECT_THAT(table, HasSubstr("sorted_grid/rows,each ball 1 rmin,1,1,\"9,000\",0.0400,0.0320,1.25×"));
  EXPECT_THAT(table,
              HasSubstr("serial_levels (its update() is detect()),frame 19 to frame 20,0.03,0.5,\"9,000\",1.10,1.08,1.02×"));
  const std::string points = file_text(out() / "updates_c4_n2969_fixture-1_gpu.dat");
  EXPECT_THAT(points, HasSubstr("0.003 0.016 0.015 0.017 \"\"\n0.1 0.016"));
  EXPECT_THAT(points, HasSubstr("0.003 0.032 0.03168 0.03232"));
  // An update of the bed at rest is not the bed's own time.
  EXPECT_THAT(file_text(out() / "trajectory_c4_n2969_fixture-1.csv"), HasSubstr("sorted_grid/rows,0.0300†,0.0320,"));
}

TEST_F(Page, HostileInputStandsBesideTheBedWithItsContactsAndRefusals) {
  const std::string table = file_text(out() / "hostile_table_fixture-1.md");
  EXPECT_THAT(table, HasSubstr("| settled bed | 3,000 | 3.00 | 4 | 200 | 10.0 |"));
  EXPECT_THAT(table, HasSubstr("| half as wide each way | 3,000 | 24.0 | 1,200 | 1600 (8.00×) | 80.0 (8.00×) |"));
  EXPECT_THAT(table, HasSubstr("| a line along x | 3,000 | 3.00 | 4 | 20000 (100×) | refused [1] |"));
  EXPECT_THAT(table, HasSubstr("[1] sorted_grid/rows, c4_n3000_line: made up: too many cells"));
  const std::string points = file_text(out() / "hostile_fixture-1_cpu.dat");
  EXPECT_THAT(points, HasSubstr("1 8 8 8 \"\" \"crowd\"\n2 1 1 1 \"\" \"line\""));
  EXPECT_THAT(points, HasSubstr("1 8 7.84158 8.16162 \"\"\n2 100 98.0198 102.02"));
  EXPECT_THAT(file_text(out() / "hostile_fixture-1_gpu.dat"), Not(HasSubstr("2 100")));
}

TEST_F(Page, SameInputSameBytes) {
  ASSERT_EQ(report("b").code, 0);
  int files = 0;
  for (const auto& file : std::filesystem::directory_iterator(out())) {
    const std::string name = file.path().filename();
    EXPECT_EQ(file_text(file.path()), file_text(folder_->path() / "b" / name)) << name;
    EXPECT_FALSE(file_text(file.path()).empty()) << name;
    ++files;
  }
  EXPECT_GE(files, 80);
}

TEST_F(Page, AStudyTakenAwayIsNamedWithTheCommandThatMakesIt) {
  const std::filesystem::path file = folder_->path() / "results/fixture-1/figure9.json", aside = folder_->path() / "figure9.json";
  std::filesystem::rename(file, aside);
  const Outcome o = report("c");
  std::filesystem::rename(aside, file);
  ASSERT_EQ(o.code, 0) << o.err;
  const std::string says =
      "no results/<device>/figure9.json; `build/gpu/bench/bench_detect --study figure9 --profile full` makes it";
  EXPECT_THAT(o.err, HasSubstr(says));
  EXPECT_THAT(file_text(folder_->path() / "c/index.html"), HasSubstr("no results/&lt;device&gt;/figure9.json; <code>build/gpu"));
  EXPECT_THAT(file_text(folder_->path() / "c/index.html"), Not(HasSubstr("id=\"figure9_")));
}

}  // namespace
}  // namespace touchstone::testing
