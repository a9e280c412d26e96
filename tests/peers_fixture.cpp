// bench_peers with made-up peers, all on the CPU: one that is right, one that loses a contact, one too slow for large packings.
#include <cstdlib>

#include "bench/command_line.h"
#include "bench/detectors.h"
#include "peers/program.h"

namespace {

using namespace touchstone;

class Losing final : public Detector {
 public:
  explicit Losing(std::unique_ptr<Detector> whole) : whole_(std::move(whole)) {}
  void detect(BallsView in, ContactsView out, Stream& stream) override {
    whole_->detect(in, out, stream);
    --*out.count;
  }
  DetectorReport report(ContactsView out, Stream& stream) override { return whole_->report(out, stream); }
  std::int64_t workspace_bytes() const override { return 0; }
  DetectorParams params() const override { return {}; }

 private:
  std::unique_ptr<Detector> whole_;
};

// Right the first time alone, which is what is verified.
class Tiring final : public Detector {
 public:
  explicit Tiring(std::unique_ptr<Detector> whole) : whole_(std::move(whole)) {}
  void detect(BallsView in, ContactsView out, Stream& stream) override {
    whole_->detect(in, out, stream);
    *out.count -= tired_;
    tired_ = 1;
  }
  DetectorReport report(ContactsView out, Stream& stream) override { return whole_->report(out, stream); }
  std::int64_t workspace_bytes() const override { return 0; }
  DetectorParams params() const override { return {}; }

 private:
  std::unique_ptr<Detector> whole_;
  std::int64_t tired_ = 0;
};

std::unique_ptr<Detector> make_right(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  auto right = find_detector("serial_multi_cell").make(facts, params, stream);
  if (std::getenv("MADEUP_TIRES")) return std::make_unique<Tiring>(std::move(right));
  return right;
}
std::unique_ptr<Detector> make_losing(const PackingFacts& facts, const DetectorParams& params, Stream& stream) {
  return std::make_unique<Losing>(make_right(facts, params, stream));
}

constexpr DetectorInfo row(const char* layout, decltype(DetectorInfo::make) make) {
  return peer_info("madeup", layout, "a fixture", "", Place::host, make);
}
constexpr PeerRow kRows[] = {{row("right", make_right)}, {row("losing", make_losing)}, {row("slow", make_right), 1000}};

std::vector<std::pair<std::string, std::string>> facts() {
  const char* version = std::getenv("MADEUP_VERSION");
  return {{"version", version ? version : "0"}};
}

}  // namespace

// A device that nobody has: what it reports is made up.
DeviceWork watch(const std::function<void()>& work) {
  work();
  static int watched = 0;
  const std::uint64_t longer = static_cast<std::uint64_t>(watched++ * 4 % 9) * 1000;  // ns, in no order
  return summed({{true, 1000, 4000 + longer}, {true, 3000, 5000}, {false, 9000, 10000}});
}

int main(int argc, char** argv) {
  return guarded("peers_fixture", [&] {
    const std::vector<Peer> peers{{"madeup", kRows, facts}};
    return peers_program({&find_detector("serial_levels")}, peers, watch, argc, argv);
  });
}
