// bench_peers: its cases, its table, and the program, with made-up peers (peers_fixture.cpp) where no GPU is.
#include "peers/program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "bench/detectors.h"
#include "tests/results_schema.h"
#include "tests/run_program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using namespace touchstone::testing;

std::vector<const DetectorInfo*> ours() { return {&find_detector("serial_levels")}; }

// Two rows; the second up to 200,000 balls.
std::vector<Peer> peers() {
  static const PeerRow rows[] = {{find_detector("all_pairs")}, {find_detector("parallel_levels"), 200'000}};
  return {{"cpu", rows, [] { return std::vector<std::pair<std::string, std::string>>{{"version", "1"}, {"built", "so"}}; }}};
}

TEST(PlanPeers, IsOneFormOneLaunchAndTiledPackingsInBothOrders) {
  const std::vector<Case> cases = plan_peers(ours(), peers(), {});
  ASSERT_EQ(cases.size(), 3 * (3 + 2 * 2));  // three packings as they are, two tiled ones in two orders
  std::set<std::string> names;
  for (const Case& c : cases) {
    EXPECT_TRUE(names.insert(c.name()).second) << c.name();
    EXPECT_EQ(c.study, "peers");
    EXPECT_EQ(c.output, OutputForm::pairs);
    EXPECT_EQ(c.launch, Launch::stream);
    EXPECT_EQ(c.cache, Cache::hot);
    EXPECT_EQ(c.protocol, Protocol::best) << "ours is tuned on another seed";
    EXPECT_EQ(c.left_out.empty(), c.detector->name != "parallel_levels" || balls_of(c.packing) <= 200'000);
  }
  EXPECT_TRUE(names.count("peers/best/serial_levels/c4_n140063/pairs"));
  EXPECT_TRUE(names.count("peers/best/all_pairs/c4_n50000_tiled10000000/pairs/sorted"));
  EXPECT_FALSE(names.count("peers/best/all_pairs/c4_n140063/pairs/sorted"));
  for (const std::string& name : names) EXPECT_EQ(name.find("ball_lists"), name.npos);
}

TEST(PlanPeers, TakesWhatIsAskedFor) {
  const auto labels = [](const PeerSelection& selection) {
    std::vector<std::string> list;
    for (const Case& c : plan_peers(ours(), peers(), selection)) list.push_back(c.name());
    return list;
  };
  EXPECT_THAT(labels({.only_packings = "n2969$", .only_detectors = "serial|pairs"}),
              ElementsAre("peers/best/serial_levels/c4_n2969/pairs", "peers/best/all_pairs/c4_n2969/pairs"));
  EXPECT_THAT(labels({.packings = {parse_spec("n=6476,c=2")}, .only_detectors = "serial"}),
              ElementsAre("peers/best/serial_levels/c2_n6476/pairs"));
  EXPECT_THAT(labels({.only_packings = "none such"}), IsEmpty());
  EXPECT_THROW(labels({.only_packings = "["}), InputError);
  EXPECT_THROW(labels({.only_detectors = "("}), InputError);
}

TEST(PeersJson, HoldsWhatEachPeerSays) {
  EXPECT_EQ(peers_json(peers()), Json::parse(R"({"peers": {"cpu": {"version": "1", "built": "so"}}})"));
}

// A fixture: times that nobody measured.
Json made_up_results() {
  const auto entry = [](const char* detector, Json layout, const char* packing, const char* order, double us) {
    return Json{{"repetition_index", 0},
                {"case",
                 {{"detector", detector},
                  {"layout", std::move(layout)},
                  {"ablation", nullptr},
                  {"packing", packing},
                  {"order", order},
                  {"n", 1000},
                  {"contacts", 3000},
                  {"median_us", us},
                  {"q1_us", us - 1},
                  {"q3_us", us + 2}}}};
  };
  Json entries = Json::array({entry("fast", nullptr, "a", "shuffled", 20), entry("lib", "tree", "a", "shuffled", 250),
                              entry("lib", "grid", "a", "shuffled", 130), entry("lib", "tree", "a", "sorted", 10)});
  Json again = entries[1];
  again["repetition_index"] = 1;
  entries.push_back(again);
  const Json skipped = {{"detector", "other"}, {"layout", nullptr},  {"packing", "a"},
                        {"order", "shuffled"}, {"code", "mismatch"}, {"message", "1 missing"}};
  return {{"context", {{"touchstone", {{"skipped", Json::array({skipped})}}}}}, {"benchmarks", entries}};
}

TEST(PeerTable, SortsByTimeAndSaysEachOneOverOurs) {
  EXPECT_EQ(peer_table(made_up_results(), {"fast"}),
            "a, shuffled: 1000 balls, 3000 contacts\n"
            "                             median ms          q1          q3    Mball/s    ratio\n"
            "  fast                          0.0200      0.0190      0.0220       50.0     1.00\n"
            "  lib/grid                      0.1300      0.1290      0.1320        7.7     6.50\n"
            "  lib/tree                      0.2500      0.2490      0.2520        4.0    12.50\n"
            "  no time: other: mismatch: 1 missing\n"
            "  lib/grid, the best peer, takes 6.50 times as long as fast\n"
            "a, sorted: 1000 balls, 3000 contacts\n"
            "                             median ms          q1          q3    Mball/s    ratio\n"
            "  lib/tree                      0.0100      0.0090      0.0120      100.0        -\n");
}

TEST(PeerTable, RefusesWhatIsNoResultsFile) {
  EXPECT_THROW(peer_table(Json::object(), {"fast"}), InputError);
  Json results = made_up_results();
  results["benchmarks"][0]["case"].erase("median_us");
  EXPECT_THROW(peer_table(results, {"fast"}), InputError);
}

TEST(DeviceWork, CountsOverlappedTimeOnceAndDurationsEach) {
  const DeviceWork w = summed({{false, 9000, 10000}, {true, 1000, 4000}, {true, 3000, 5000}, {true, 3500, 4500}});
  EXPECT_EQ(w.kernels, 3);
  EXPECT_EQ(w.transfers, 1);
  EXPECT_DOUBLE_EQ(w.kernels_us, 6);
  EXPECT_DOUBLE_EQ(w.transfers_us, 1);
  EXPECT_DOUBLE_EQ(w.busy_us, 5);
  EXPECT_EQ(summed({}).busy_us, 0);
}

TEST(KernelTable, SortsByBusyTimeAndSaysEachOneOverOurs) {
  const auto record = [](const char* detector, Json layout, double busy) {
    return Json{{"detector", detector},
                {"layout", std::move(layout)},
                {"packing", "a"},
                {"order", "sorted"},
                {"n", 10},
                {"contacts", 3},
                {"kernels", 4},
                {"transfers", 1},
                {"kernels_us", busy + 1},
                {"transfers_us", 2},
                {"busy_us", busy}};
  };
  const Json skipped = {{"detector", "other"}, {"packing", "a"}, {"order", "sorted"}, {"code", "failed"}, {"message", "no room"}};
  Json results = {{"cases", Json::array({record("lib", "tree", 50), record("fast", nullptr, 20)})},
                  {"skipped", Json::array({skipped})}};
  EXPECT_EQ(kernel_table(results, {"fast"}),
            "a, sorted: 10 balls, 3 contacts\n"
            "                             kernels    copies  kernels ms   copies ms     busy ms    ratio\n"
            "  fast                             4         1      0.0210      0.0020      0.0200     1.00\n"
            "  lib/tree                         4         1      0.0510      0.0020      0.0500     2.50\n"
            "  no time: other on a, sorted: failed: no room\n");
  results["cases"][0].erase("busy_us");
  EXPECT_THROW(kernel_table(results, {"fast"}), InputError);
}

class Program : public ::testing::Test {
 protected:
  // On 300 and 1,500 loose balls.
  Outcome run(const std::string& more, const std::string& version = "1") const {
    const bool times = more.find("--kernels") == std::string::npos;
    return run_program("MADEUP_VERSION=" + version + " " PEERS_FIXTURE " --out " + out().string() + " --packing-folder " +
                       (folder_.path() / "packings").string() + (times ? " --seconds 0.05" : "") + " --force" + more);
  }
  std::filesystem::path out() const { return folder_.path() / "out.json"; }
  static constexpr const char* kTwo =
      " --packing n=300,c=3,kind=loose,phi=0.5,base=cube --packing n=1500,c=3,kind=loose,phi=0.5,base=cube";
  TemporaryFolder folder_;
};

TEST_F(Program, TimesWhatIsRightAndNothingElse) {
  const Outcome o = run(kTwo);
  EXPECT_EQ(o.code, kExitMismatch) << o.err;
  const json file = parse_strictly(file_text(out()));
  EXPECT_THAT(SchemaCheck().faults(file), IsEmpty());
  EXPECT_EQ(file["context"]["touchstone"]["peers"]["madeup"]["version"], "1");
  EXPECT_THAT(file["context"]["executable"].get<std::string>(), HasSubstr("peers_fixture"));
  std::multiset<std::string> timed, skipped;
  for (const json& e : file["benchmarks"]) {
    if (e["repetition_index"] != 0) continue;
    const json& c = e["case"];
    EXPECT_EQ(c["output"], "pairs");
    timed.insert(c["detector"].get<std::string>() + "/" + c.value("layout", json()).dump() + "/" +
                 std::to_string(c["n"].get<int>()));
  }
  EXPECT_EQ(timed, (std::multiset<std::string>{"serial_levels/null/300", "serial_levels/null/1500", "madeup/\"right\"/300",
                                               "madeup/\"right\"/1500", "madeup/\"slow\"/300"}));
  for (const json& s : file["context"]["touchstone"]["skipped"])
    skipped.insert(s["layout"].get<std::string>() + ": " + s["code"].get<std::string>());
  EXPECT_EQ(skipped, (std::multiset<std::string>{"losing: mismatch", "losing: mismatch", "slow: time"}));
  EXPECT_THAT(o.out, HasSubstr("\nc3_n300_cube_loose50, shuffled: 300 balls, "));
  EXPECT_THAT(o.out, HasSubstr("  no time: madeup/losing: mismatch: "));
  EXPECT_THAT(o.out, HasSubstr(", the best peer, takes "));
}

TEST_F(Program, SaysHowLongTheDeviceWorksForWhatIsRight) {
  const Outcome o = run(std::string(kTwo) + " --kernels");
  EXPECT_EQ(o.code, kExitMismatch) << o.err;
  const json file = parse_strictly(file_text(out()));
  EXPECT_EQ(file["schema"], "touchstone-peers-kernels/1");
  EXPECT_FALSE(file["run"]["complete"]) << "one of them is wrong";
  EXPECT_EQ(file["peers"]["madeup"]["version"], "1");
  EXPECT_EQ(file["cases"].size(), 5) << "two of ours, two that are right, one slow but small enough";
  for (const json& c : file["cases"]) {
    EXPECT_DOUBLE_EQ(c["busy_us"], 8) << "the median of nine";
    EXPECT_DOUBLE_EQ(c["kernels_us"], 9);
  }
  EXPECT_EQ(file["skipped"].size(), 3);
  EXPECT_THAT(o.out, HasSubstr("  no time: madeup/losing on c3_n300_cube_loose50, shuffled: mismatch: "));
}

TEST_F(Program, ComparesAgainWhatWasTimedOrWatched) {
  const std::string small = " --packing n=300,c=3,kind=loose,phi=0.5,base=cube --detectors 'serial|right'";
  for (const auto& [more, when] : {std::pair{"", "after timing: "}, {" --kernels", "after watching: "}}) {
    const Outcome o = run(small + more, "1 MADEUP_TIRES=1");
    EXPECT_EQ(o.code, kExitMismatch) << o.err;
    EXPECT_THAT(o.out, HasSubstr(when));
  }
}

TEST_F(Program, MeasuresAgainWhatAnotherVersionOfALibraryWasMeasuredWith) {
  const std::string small = " --packing n=300,c=3,kind=loose,phi=0.5,base=cube --detectors 'serial|right'";
  EXPECT_EQ(run(small).code, kExitOk);
  EXPECT_THAT(run(small).err, HasSubstr("2 of 2 cases were measured before"));
  EXPECT_THAT(run(small, "2").err, Not(HasSubstr("measured before")));
}

TEST_F(Program, RefusesInOneLine) {
  const auto refused = [&](const std::string& words, const char* what) {
    const Outcome o = run(words);
    EXPECT_EQ(o.code, kExitInput) << words;
    EXPECT_THAT(o.err, HasSubstr(what));
    EXPECT_EQ(std::count(o.err.begin(), o.err.end(), '\n'), 1) << o.err;
  };
  refused(" --packings '['", "--packings '[' is no regular expression");
  refused(" --packing n=-3", "n");
  refused(" --seconds 0", "--seconds");
  refused(" --detector serial", "--detector");
  refused(" --kernels --fresh", "--fresh");
  refused(" --kernels --seconds 1", "--seconds");
  const Outcome none = run(std::string(kTwo) + " --detectors unheard_of");
  EXPECT_EQ(none.code, kExitNothingRan);
  EXPECT_THAT(none.err, HasSubstr("no case matches"));
  EXPECT_FALSE(std::filesystem::exists(out()));
}

TEST_F(Program, ListsItsCasesAndMeasuresNothing) {
  const Outcome o = run(std::string(kTwo) + " --list");
  EXPECT_EQ(o.code, kExitOk) << o.err;
  EXPECT_THAT(o.out, HasSubstr("peers/best/madeup/right/c3_n1500_cube_loose50/pairs\n"));
  EXPECT_THAT(o.out,
              HasSubstr("peers/best/madeup/slow/c3_n1500_cube_loose50/pairs  left out, time: madeup/slow is measured to 1000"));
  EXPECT_FALSE(std::filesystem::exists(out()));
}

}  // namespace
}  // namespace touchstone
