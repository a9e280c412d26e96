// bench_cpu_peers FILE.balls [RUNS]: our CPU detectors beside two well-known libraries, on one packing, in one process.
// Each competitor is first checked to find the same contacts; then all run in turn, RUNS times (default 9, at least 9), and
// medians are printed, also of the processor time, which on a busy machine is the better judge of one core's work. A run goes
// from balls in memory to the complete pair list; all but parallel_levels use one core.
//
// The libraries are used as their documentation advises: nanoflann with a result set of our own (no list of candidates is
// stored), reading the balls in place; CGAL with pointers to boxes or boxes, whichever is faster. Their one parameter
// (leaf size, cutoff) is swept first, as is serial_multi_cell's cell. CGAL is GPL: this optional program alone uses it.
#include <CGAL/box_intersection_d.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <functional>
#include <nanoflann.hpp>
#include <string>
#include <thread>
#include <vector>

#include "kernels/detection.h"
#include "touchstone/contact.h"
#include "touchstone/error.h"

using namespace touchstone;

namespace {

struct Time {
  double wall_ms = 0, processor_ms = 0;  // the second summed over threads
};

double processor_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

Time time_of(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  const double processor = processor_ms();
  work();
  return {std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count(),
          processor_ms() - processor};
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// A pair list that keeps its memory between runs, as our detectors' output does.
struct Pairs {
  std::vector<Pair> list;
  void clear() { list.clear(); }
  void add(std::int32_t i, std::int32_t j) { list.push_back({std::min(i, j), std::max(i, j)}); }
};

// --- nanoflann -----------------------------------------------------------------------------------------------------------

struct Cloud {
  const std::vector<Ball>& balls;
  std::size_t kdtree_get_point_count() const { return balls.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return (&balls[i].x)[axis]; }
  template <class Bounds>
  bool kdtree_get_bbox(Bounds&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::int32_t>;

enum class Ask { up_to_rmax, larger_asks };

// Takes the place of nanoflann's list of neighbours: in_contact() decides at once.
struct ContactsOf {
  using DistanceType = float;
  const std::vector<Ball>& balls;
  std::int32_t i;
  float squared_radius;
  Ask ask;
  Pairs& out;

  void init() {}
  void clear() {}
  std::size_t size() const { return 0; }
  bool full() const { return true; }
  float worstDist() const { return squared_radius; }
  bool addPoint(float, std::int32_t j) {
    // Each pair once: from its lower number, or from its larger ball.
    const float ri = balls[i].r, rj = balls[j].r;
    const bool mine = ask == Ask::up_to_rmax ? i < j : rj < ri || (rj == ri && i < j);
    if (mine && in_contact(balls[i], balls[j])) out.add(i, j);
    return true;
  }
};

void nanoflann_contacts(const std::vector<Ball>& balls, float rmax, int leaf, Ask ask, Pairs& out) {
  out.clear();
  const Cloud cloud{balls};
  Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(leaf));
#if NANOFLANN_VERSION < 0x150
  tree.buildIndex();  // from 1.5 on the constructor does it
#endif
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(balls.size()); ++i) {
    const float reach = pad(balls[i].r + (ask == Ask::up_to_rmax ? rmax : balls[i].r));
    ContactsOf result{balls, i, reach * reach * 1.00001f, ask, out};
    tree.findNeighbors(result, &balls[i].x, nanoflann::SearchParams(32, 0, false));
  }
}

// --- CGAL ----------------------------------------------------------------------------------------------------------------

using CgalBox = CGAL::Box_intersection_d::Box_with_info_d<float, 3, std::int32_t, CGAL::Box_intersection_d::ID_EXPLICIT>;

struct CgalInput {
  std::vector<CgalBox> boxes;
  std::vector<CgalBox*> pointers;
};

void cgal_contacts(const std::vector<Ball>& balls, std::ptrdiff_t cutoff, bool by_pointer, CgalInput& in, Pairs& out) {
  out.clear();
  in.boxes.clear();
  in.pointers.clear();
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(balls.size()); ++i) {
    const Ball& b = balls[i];
    const float reach = pad(b.r);
    float lower[3] = {b.x - reach, b.y - reach, b.z - reach}, upper[3] = {b.x + reach, b.y + reach, b.z + reach};
    in.boxes.emplace_back(lower, upper, i);
  }
  const auto decide = [&](std::int32_t i, std::int32_t j) {
    if (in_contact(balls[i], balls[j])) out.add(i, j);
  };
  if (by_pointer) {
    for (CgalBox& box : in.boxes) in.pointers.push_back(&box);
    CGAL::box_self_intersection_d(
        in.pointers.begin(), in.pointers.end(), [&](const CgalBox* a, const CgalBox* b) { decide(a->info(), b->info()); },
        cutoff);
  } else {
    CGAL::box_self_intersection_d(
        in.boxes.begin(), in.boxes.end(), [&](const CgalBox& a, const CgalBox& b) { decide(a.info(), b.info()); }, cutoff);
  }
}

// --- ours ----------------------------------------------------------------------------------------------------------------

const DetectorInfo& cpu_detector(std::string_view name) {
  for (const DetectorInfo& info : cpu_detectors())
    if (info.name == name) return info;
  throw std::logic_error("no such detector");
}

// --- the contest ---------------------------------------------------------------------------------------------------------

struct Competitor {
  std::string name;
  std::function<void()> run;
  std::function<ContactList()> contacts;  // of the last run
  std::vector<double> wall_ms = {}, processor_ms = {};
};

// The parameter with the least time of three runs each.
template <class Run>
int best_of(const std::vector<int>& candidates, Run&& run) {
  int best = candidates.front();
  double least = HUGE_VAL;
  for (const int candidate : candidates)
    for (int repeat = 0; repeat < 3; ++repeat) {
      const double ms = time_of([&] { run(candidate); }).processor_ms;
      if (ms < least) least = ms, best = candidate;
    }
  return best;
}

std::vector<Ball> read_balls(const std::string& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  if (!file) throw InputError(path + ": cannot be read");
  const auto bytes = static_cast<std::size_t>(file.tellg());
  if (bytes == 0 || bytes % sizeof(Ball) != 0)
    throw InputError(fmt::format("{}: {} bytes are no list of balls (16 bytes each)", path, bytes));
  std::vector<Ball> balls(bytes / sizeof(Ball));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(balls.data()), static_cast<std::streamsize>(bytes));
  validate(balls, path);
  return balls;
}

int contest(const std::string& path, int runs) {
  const std::vector<Ball> balls = read_balls(path);
  const PackingFacts facts = facts_of(balls);
  Stream stream(Place::host);
  Pairs found;
  CgalInput cgal_input;
  std::vector<Detection> detections;
  detections.reserve(8);
  std::vector<Competitor> competitors;

  const auto from_found = [&] { return from_pairs(found.list, facts.n); };
  for (const Ask ask : {Ask::up_to_rmax, Ask::larger_asks}) {
    const auto run = [&, ask](int leaf) { nanoflann_contacts(balls, facts.rmax, leaf, ask, found); };
    const int leaf = best_of({8, 16, 32, 64, 128}, run);
    const char* how = ask == Ask::up_to_rmax ? "ri + rmax, j > i" : "2 ri, larger asks";
    competitors.push_back({fmt::format("nanoflann ({}, leaf {})", how, leaf), [=] { run(leaf); }, from_found});
  }
  for (const bool by_pointer : {false, true}) {
    const auto run = [&, by_pointer](int cutoff) { cgal_contacts(balls, cutoff, by_pointer, cgal_input, found); };
    const int cutoff = best_of({10, 100, 400, 800, 1600, 3200}, run);
    competitors.push_back({fmt::format("CGAL box_self_intersection_d ({}, cutoff {})", by_pointer ? "pointers" : "boxes", cutoff),
                           [=] { run(cutoff); }, from_found});
  }
  const auto add_detector = [&](const std::string& name, std::string_view detector, double cell) {
    detections.push_back(detect_completely(cpu_detector(detector), balls, facts, {.cell = cell}, OutputForm::pairs, stream));
    const Detection* d = &detections.back();
    competitors.push_back({name, [=, &stream] { d->detector->detect(d->input(), d->output->view(), stream); },
                           [=, &stream] { return d->output->download(stream); }});
  };
  const int cell = best_of({4, 5, 6, 7, 8, 9, 10, 12, 14}, [&](int factor) {
    static int built = 0;
    static Detection d;
    if (built != factor) {
      d = detect_completely(cpu_detector("serial_multi_cell"), balls, facts, {.cell = factor * facts.ravg}, OutputForm::pairs,
                            stream);
      built = factor;
    } else {
      d.detector->detect(d.input(), d.output->view(), stream);
    }
  });
  add_detector("serial_multi_cell (cell 2 ravg)", "serial_multi_cell", 2 * facts.ravg);
  add_detector(fmt::format("serial_multi_cell (cell {} ravg)", cell), "serial_multi_cell", cell * facts.ravg);
  add_detector("serial_levels", "serial_levels", 0);
  add_detector(fmt::format("parallel_levels ({} threads)", std::thread::hardware_concurrency()), "parallel_levels", 0);

  ContactList reference;
  for (Competitor& c : competitors) {
    c.run();
    const ContactList contacts = c.contacts();
    if (&c == &competitors.front()) reference = contacts;
    const ContactDifference difference = compare(contacts, reference);
    if (!difference.equal()) {
      fmt::print(stderr, "{} differs from {}: {}\n", c.name, competitors.front().name, difference.text());
      return kExitMismatch;
    }
  }
  for (int run = 0; run < runs; ++run)
    for (Competitor& c : competitors) {
      const Time t = time_of(c.run);
      c.wall_ms.push_back(t.wall_ms);
      c.processor_ms.push_back(t.processor_ms);
    }

  fmt::print("{}: {} balls, C = {:.2f}, {} contacts, equal for all; {} runs in turn\n", path, facts.n, facts.cell_factor(),
             reference.count(), runs);
  fmt::print("{:<52} {:>10} {:>12} {:>18} {:>18}\n", "", "median ms", "ns a ball", "processor median", "processor least");
  for (const Competitor& c : competitors) {
    const double wall = median(c.wall_ms), least = *std::min_element(c.processor_ms.begin(), c.processor_ms.end());
    fmt::print("{:<52} {:>10.3f} {:>12.1f} {:>18.1f} {:>18.1f}\n", c.name, wall, 1e6 * wall / facts.n,
               1e6 * median(c.processor_ms) / facts.n, 1e6 * least / facts.n);
  }
  return kExitOk;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 2 || argc > 3) throw InputError("usage: bench_cpu_peers FILE.balls [RUNS]");
  return contest(argv[1], std::max(9, argc == 3 ? std::atoi(argv[2]) : 9));
} catch (const InputError& e) {
  fmt::print(stderr, "bench_cpu_peers: {}\n", e.what());
  return kExitInput;
}
