// Radii by quota, loose packings, and the cache that keeps packings.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <numbers>
#include <set>

#include "datasets/files.h"
#include "datasets/loose.h"
#include "datasets/radii.h"
#include "datasets/store.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

double mean_cm(const PackingSpec& spec) {
  Random random(spec.seed, 1);
  double sum = 0;
  for (const float r : draw_radii(spec, random)) sum += r;
  return 100 * sum / spec.n;
}

// Zheng et al. 2012, Table 1: mean radius in cm for C = 1 … 6, cut (not rounded) to two decimals.
TEST(Radii, Table1IsReproduced) {
  const int kPrinted[] = {25, 25, 26, 27, 28, 29};  // 0.01 cm
  for (int c = 1; c <= 6; ++c) {
    PackingSpec spec;
    spec.n = 50000;
    spec.cell_factor = c;
    // 1e-6: radii are float32, so the mean of C = 1 is 0.25 only to eight digits.
    EXPECT_EQ(static_cast<int>(std::floor(100 * mean_cm(spec) + 1e-6)), kPrinted[c - 1]) << "C = " << c;
    EXPECT_NEAR(mean_cm(spec), 100 * expected_mean_radius(spec), 1e-7);
  }
}

TEST(Radii, EveryMixtureHasItsMeanAndRange) {
  for (const Mix mix : {Mix::table1, Mix::uniform, Mix::bidisperse, Mix::power_law, Mix::scc30}) {
    PackingSpec spec;
    spec.mix = mix;
    spec.n = 100000;
    spec.cell_factor = 5;
    Random random(7, 1);
    const std::vector<float> radii = draw_radii(spec, random);
    EXPECT_NEAR(mean_cm(spec), 100 * expected_mean_radius(spec), 2e-5 * mean_cm(spec)) << static_cast<int>(mix);
    EXPECT_GE(*std::min_element(radii.begin(), radii.end()), 0.0025f * (1 - 1e-6f));
    EXPECT_LE(*std::max_element(radii.begin(), radii.end()), 0.0125f * (1 + 1e-6f));
    const std::set<float> distinct(radii.begin(), radii.end());
    EXPECT_GE(static_cast<double>(distinct.size()), 0.99 * static_cast<double>(continuous_count(spec)));
  }
}

TEST(Radii, Scc30HasThirtyPercentOfItsVolumeAboveRmin) {
  PackingSpec spec;
  spec.mix = Mix::scc30;
  spec.n = 200000;
  Random random(1, 1);
  double above = 0, all = 0;
  for (const float r : draw_radii(spec, random)) {
    const double v = static_cast<double>(r) * r * r;
    all += v;
    if (r > 0.0025f) above += v;
  }
  EXPECT_NEAR(above / all, 0.30, 0.001);
}

TEST(Loose, FillsItsBoxToTheSolidFraction) {
  for (const char* text : {"n=3000,c=4,kind=loose,phi=0.5,base=cube", "n=3000,c=100,kind=loose,phi=0.3,base=cube,mix=power_law",
                           "n=3000,c=2,kind=loose,phi=0.1,base=5x7,mix=uniform"}) {
    const PackingSpec spec = parse_spec(text);
    const Packing packing = make_loose(spec);
    const PackingFacts facts = facts_of(packing.balls);
    double volume = 0, box = 1;
    for (const Ball& b : packing.balls) volume += 4.0 / 3 * std::numbers::pi * std::pow(b.r, 3);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_GE(facts.surfaces.lower[axis], -1e-6f);
      box *= facts.surfaces.upper[axis];
    }
    EXPECT_NEAR(volume / box, spec.solid_fraction, 0.02 * spec.solid_fraction) << text;
  }
  EXPECT_THROW(make_loose(parse_spec("n=1,c=4,kind=loose,mix=uniform,phi=5,base=cube")), InputError);
}

TEST(Loose, KnownBytes) {
  EXPECT_EQ(packing_hash(make_loose(parse_spec("n=1000,kind=loose,base=cube")).balls), 0x4c6a5024a5a4c5c5ull);
  EXPECT_NE(packing_hash(make_loose(parse_spec("n=1000,kind=loose,base=cube,seed=2")).balls), 0x4c6a5024a5a4c5c5ull);
}

class Store : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() / ("touchstone_store_test_" + std::to_string(::getpid()));
    std::filesystem::remove_all(folder_);
    first_ = packing_hash(load_or_make(spec_, folder_).balls);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path file(const char* extension) const { return folder_ / (name_of(spec_) + extension); }

  // What the cache says on stderr when asked again; the answer must be the first one's whatever happened between.
  std::string ask_again() {
    ::testing::internal::CaptureStderr();
    EXPECT_EQ(packing_hash(load_or_make(spec_, folder_).balls), first_);
    return ::testing::internal::GetCapturedStderr();
  }

  const PackingSpec spec_ = parse_spec("n=200,c=2.5,kind=loose,base=cube");
  std::filesystem::path folder_;
  std::uint64_t first_ = 0;
};

TEST_F(Store, IsUsed) {
  const auto written = std::filesystem::last_write_time(file(".balls"));
  EXPECT_EQ(ask_again(), "");
  EXPECT_EQ(std::filesystem::last_write_time(file(".balls")), written);
  const auto cached = list_cached(folder_);
  ASSERT_EQ(cached.size(), 1u);
  EXPECT_EQ(cached[0].name, "c2.5_n200_cube_loose60");
  EXPECT_EQ(cached[0].n, 200);
}

TEST_F(Store, LooksWithoutALock) {
  std::filesystem::remove(file(".lock"));
  EXPECT_EQ(ask_again(), "");
  ASSERT_FALSE(std::filesystem::exists(file(".lock"))) << "a complete cache must do in a folder that is read-only";
  const FileLock other(file(".lock"), [] {});
  EXPECT_EQ(ask_again(), "") << "a complete cache must do while another process holds the lock";
}

TEST_F(Store, WaitsForAnotherMakerAndCanBeStopped) {
  std::filesystem::remove(file(".json"));
  auto other = std::make_unique<FileLock>(file(".lock"), [] {});
  ::testing::internal::CaptureStderr();
  int calls = 0;
  const auto stop = [&](double, std::string_view) {
    if (++calls == 3) throw Interrupted();
  };
  EXPECT_THROW(load_or_make(spec_, folder_, stop), Interrupted);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(),
            folder_.string() + ": another process makes " + name_of(spec_) + "; waiting for it\n");
  const auto release = [&](double, std::string_view) { other.reset(); };
  EXPECT_EQ(packing_hash(load_or_make(spec_, folder_, release).balls), first_);
  EXPECT_EQ(ask_again(), "") << "it was made once the lock was free";
}

TEST_F(Store, NoticesAChangedByte) {
  std::string bytes = read_whole(file(".balls"));
  bytes[1234] ^= 1;
  write_atomically(file(".balls"), bytes);
  EXPECT_NE(ask_again().find("hash differs"), std::string::npos);
  EXPECT_EQ(ask_again(), "");
}

TEST_F(Store, NoticesATornFile) {
  write_atomically(file(".balls"), read_whole(file(".balls")).substr(0, 1600));
  EXPECT_NE(ask_again().find("wrong size"), std::string::npos);
}

TEST_F(Store, NoticesALostOrBrokenJson) {
  write_atomically(file(".json"), "{\"spec\": ");
  EXPECT_NE(ask_again().find("missing or damaged"), std::string::npos);
  std::filesystem::remove(file(".json"));
  EXPECT_NE(ask_again().find("missing or damaged"), std::string::npos);
}

TEST_F(Store, NoticesAnotherGenerator) {
  nlohmann::json meta = nlohmann::json::parse(read_whole(file(".json")));
  meta["generator_version"] = kGeneratorVersion - 1;
  write_atomically(file(".json"), meta.dump());
  EXPECT_NE(ask_again().find("another version"), std::string::npos);
}

TEST_F(Store, WritesThroughALinkAndIntoAPipe) {
  const std::filesystem::path target = folder_ / "target", link = folder_ / "link", pipe = folder_ / "pipe";
  write_atomically(target, "old");
  std::filesystem::create_symlink(target, link);
  write_atomically(link, "new");
  EXPECT_EQ(read_whole(target), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(link));

  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK);
  write_atomically(pipe, "through");
  char got[16] = {};
  EXPECT_EQ(::read(reader, got, sizeof got), 7);
  EXPECT_STREQ(got, "through");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  ::close(reader);
  if (std::filesystem::exists("/dev/full")) {  // by a link of our own, so that no fault of ours can cost the device
    std::filesystem::create_symlink("/dev/full", folder_ / "full");
    EXPECT_THROW(write_atomically(folder_ / "full", "x"), InputError);
  }
}

TEST(StoreFolder, IsToldWhenItCannotBe) {
  EXPECT_THROW(load_or_make(parse_spec("n=10,kind=loose,base=cube"), "/dev/null/packings"), InputError);
}

// Sets or, with null, unsets a variable while it lives.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* const before = std::getenv(name)) before_ = before, was_set_ = true;
    set(value);
  }
  ~Variable() { set(was_set_ ? before_.c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) const { value ? ::setenv(name_, value, 1) : ::unsetenv(name_); }
  const char* name_;
  std::string before_;
  bool was_set_ = false;
};

TEST(PackingFolder, OfOtherProgramsIsTheUsersCacheNeverTheSourceTree) {
  const Variable home("HOME", "/home/someone"), source("TOUCHSTONE_SOURCE_DIR", "/src/tree");
  {
    const Variable stated("TOUCHSTONE_PACKINGS", "/data/packings"), cache("XDG_CACHE_HOME", "/var/cache");
    EXPECT_EQ(default_packing_folder(), "/data/packings");
    EXPECT_EQ(source_packing_folder(), "/data/packings");
  }
  const Variable stated("TOUCHSTONE_PACKINGS", nullptr);
  EXPECT_EQ(source_packing_folder(), "/src/tree/build/packings");
  {
    const Variable cache("XDG_CACHE_HOME", "/var/cache");
    EXPECT_EQ(default_packing_folder(), "/var/cache/touchstone/packings");
  }
  for (const char* useless : {static_cast<const char*>(nullptr), "", "relative"}) {
    const Variable cache("XDG_CACHE_HOME", useless);
    EXPECT_EQ(default_packing_folder(), "/home/someone/.cache/touchstone/packings");
    const Variable nowhere("HOME", nullptr);
    try {
      default_packing_folder();
      FAIL() << "a folder out of nowhere";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("TOUCHSTONE_PACKINGS"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace touchstone
