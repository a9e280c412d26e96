// Specs: what users write, the names they get, and how mistakes are told.
#include "datasets/spec.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

std::string message(const std::string& text) {
  try {
    parse_spec(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Spec, TextRoundTrip) {
  const PackingSpec spec =
      parse_spec("n=123,c=2.5,seed=18446744073709551615,base=10x12.5,mix=scc30,kind=loose,phi=0.35,rmin_cm=0.1");
  EXPECT_EQ(spec.n, 123);
  EXPECT_EQ(spec.cell_factor, 2.5);
  EXPECT_EQ(spec.seed, 18446744073709551615ull);
  EXPECT_DOUBLE_EQ(spec.base_x, 0.10);
  EXPECT_DOUBLE_EQ(spec.base_y, 0.125);
  EXPECT_EQ(spec.mix, Mix::scc30);
  EXPECT_EQ(spec.kind, PackingKind::loose);
  EXPECT_DOUBLE_EQ(spec.rmin, 0.001);
  EXPECT_EQ(to_string(parse_spec(to_string(spec))), to_string(spec));
  const PackingSpec frame = parse_spec("n=500,frame=7");
  EXPECT_EQ(to_string(parse_spec(to_string(frame))), to_string(frame));
  EXPECT_EQ(to_string(settled_of(frame)), to_string(parse_spec("n=500"))) << "caches keep this text: it must not change";
}

TEST(Spec, NamesAreShortAndUnique) {
  EXPECT_EQ(name_of(parse_spec("n=20653")), "c4_n20653");
  EXPECT_EQ(name_of(parse_spec("n=500,c=2,seed=2,base=10x10")), "c2_n500_s2_b10x10");
  EXPECT_EQ(name_of(parse_spec("n=500,kind=loose,base=cube")), "c4_n500_cube_loose60");
  EXPECT_EQ(name_of(parse_spec("n=500,frame=7")), "c4_n500_f007");
  std::set<std::string> names;
  const char* kTexts[] = {"n=500",
                          "n=501",
                          "c=3,n=500",
                          "seed=2,n=500",
                          "mix=uniform,n=500",
                          "base=10x20,n=500",
                          "base=20x10,n=500",
                          "n=500,rmin_cm=1,c=1",
                          "kind=loose,n=500",
                          "kind=loose,phi=0.601,n=500",
                          "n=500,frame=0",
                          "n=500,frame=10"};
  for (const char* text : kTexts) names.insert(name_of(parse_spec(text)));
  EXPECT_EQ(names.size(), std::size(kTexts));
}

TEST(Spec, TiledIsAWordOfItsOwnAndOldNamesStay) {
  const PackingSpec spec = parse_spec("n=50000,c=1,tiled=1000000000");
  EXPECT_EQ(spec.n, 50000);
  EXPECT_EQ(spec.tiled, 1'000'000'000);
  EXPECT_EQ(name_of(spec), "c1_n50000_tiled1000000000");
  EXPECT_EQ(name_of(base_of(spec)), "c1_n50000");
  EXPECT_EQ(balls_of(spec), 1'000'000'000);
  EXPECT_EQ(balls_of(base_of(spec)), 50000);
  EXPECT_EQ(to_string(parse_spec(to_string(spec))), to_string(spec));
  EXPECT_EQ(to_string(base_of(spec)).find("tiled"), std::string::npos);
  EXPECT_EQ(parse_spec("tiled=2147483647").tiled, 2147483647);
  EXPECT_EQ(message("tiled=2147483648"),
            "spec: tiled=2147483648: 34359738368 bytes of balls; ball numbers are 32-bit, so at most 2147483647 balls");
  EXPECT_NE(message("tiled=4000000000").find("64000000000 bytes"), std::string::npos);
  EXPECT_NE(message("n=500,frame=3,tiled=9").find("give one of the two"), std::string::npos);
  EXPECT_NE(message("tiled=-1").find("must be a number from 0"), std::string::npos);
}

TEST(Spec, MistakesNameKeyAndRemedy) {
  EXPECT_EQ(message("n=0"), "spec: n=0: must be a number from 1 to 2147483647");
  EXPECT_EQ(message("n=3000000000"), "spec: n=3000000000: must be a number from 1 to 2147483647");
  EXPECT_EQ(message("c=0.5"), "spec: c=0.5: must be a number from 1 to 10000");
  EXPECT_EQ(message("c=nan"), "spec: c=nan: must be a number from 1 to 10000");
  EXPECT_EQ(message("n=5x"), "spec: n=5x: must be a number from 1 to 2147483647");
  EXPECT_EQ(message("mix=gravel"), "spec: mix=gravel: must be one of table1, uniform, bidisperse, power_law, scc30");
  EXPECT_EQ(message("N=5"), "spec: N=5: no such key; known are n, c, seed, base, mix, kind, phi, rmin_cm, frame, shape, moved, tiled");
  EXPECT_EQ(message("n=500,frame=101"), "spec: frame=101: must be a number from 0 to 100");
  EXPECT_NE(message("n=500,kind=loose,frame=3").find("loose packings are not settled"), std::string::npos);
  EXPECT_EQ(message("n=5,n=6"), "spec: n: given twice");
  EXPECT_EQ(message("n=5,"), "accepted");
  EXPECT_EQ(message("n=5,c"), "spec: c: must be key=value");
  EXPECT_NE(message("base=20").find("WIDTHxDEPTH"), std::string::npos);
  EXPECT_NE(message("base=cube").find("needs a floor"), std::string::npos);
  EXPECT_NE(message("base=2x2").find("too narrow"), std::string::npos);
  EXPECT_NE(message("no_such_file.json").find("neither"), std::string::npos);
}

TEST(Spec, JsonFileAndSets) {
  const auto path = std::filesystem::temp_directory_path() / "touchstone_spec_test.json";
  std::ofstream(path) << R"({"n": 77, "c": 3, "base": "10x10"})";
  EXPECT_EQ(name_of(parse_spec(path.string())), "c3_n77_b10x10");
  std::ofstream(path) << R"({"n": 77.5})";
  EXPECT_NE(message(path.string()).find("n=77.5"), std::string::npos);
  std::ofstream(path) << R"({"n": )";
  EXPECT_NE(message(path.string()).find("not JSON"), std::string::npos);
  std::filesystem::remove(path);
  EXPECT_EQ(load_spec_set(spec_folder() / "table2.json").size(), 7u);
  const auto figure6 = load_spec_set(spec_folder() / "figure6.json");
  ASSERT_EQ(figure6.size(), 6u);
  for (int c = 1; c <= 6; ++c) EXPECT_EQ(name_of(figure6[c - 1]), "c" + std::to_string(c) + "_n50000");
}

}  // namespace
}  // namespace touchstone
