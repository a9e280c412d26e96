#include "bench/report/figure8.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace touchstone::report {
namespace {

// Numbers that plots/figure8.gp gives colour, dash and marker. Each GPU has two looks, from kFirstGpu on; each of its speed-ups
// over another base a look, from kFirstSpeedup on.
enum Look { kPaperCpu = 1, kPaperGtx285, kPaperGtx580, kSerialPaper, kSerialBest, kParallel, kThisMachine, kFirstGpu };
constexpr std::size_t kMostGpus = 3;  // that the looks can tell apart
constexpr int kLooksAGpu = 4;
enum GpuLook { kAsPublished = 0, kAtItsBest, kOverSerial, kOverParallel };

struct Point {
  double n, value, low, high;
  std::string marks;
};

Query at(const std::string& detector, const std::string& protocol, const std::string& launch = "stream") {
  return {detector, protocol, launch, "hot", "ball_lists", 0};
}

std::vector<Point> points(const Device& d, Query q) {
  std::vector<Point> list;
  for (const Row& r : d.rows) {
    q.n = r.n;
    if (find(d.rows, q) == &r)
      list.push_back({static_cast<double>(r.n), 1e-3 * r.median_us, 1e-3 * r.q1_us, 1e-3 * r.q3_us, r.marks});
  }
  return list;
}

std::vector<Point> published_points(const std::vector<Row>& rows, const std::string& device) {
  std::vector<Point> list;
  for (const Row& r : rows)
    if (r.device == device) list.push_back({static_cast<double>(r.n), 1e-3 * r.median_us, NAN, NAN, ""});
  return list;
}

std::vector<Point> ratio(const std::vector<Point>& base, const std::vector<Point>& time) {
  std::vector<Point> list;
  for (const Point& b : base)
    for (const Point& t : time)
      if (b.n == t.n) list.push_back({b.n, b.value / t.value, NAN, NAN, b.marks.empty() ? t.marks : b.marks});
  return list;
}

using Blocks = std::vector<Block>;

void add(Blocks& panel, std::string label, int look, const std::vector<Point>& list) {
  if (list.empty()) return;
  Block b{std::move(label), look, {}};
  for (const Point& p : list)
    b.rows.push_back({number(p.n), number(p.value), number_or_missing(p.low), number_or_missing(p.high), in_quotes(p.marks)});
  panel.push_back(std::move(b));
}

// The GPU detector that is fastest at the largest size, at its own best; "" if none was measured.
std::string fastest_gpu_detector(const Device& d) {
  const Row* best = nullptr;
  for (const Row& r : d.rows) {
    if (r.place != "gpu" || r.protocol != "best" || r.launch != "stream" || r.cache != "hot" || r.output != "ball_lists")
      continue;
    if (!best || r.n > best->n || (r.n == best->n && r.median_us < best->median_us)) best = &r;
  }
  return best ? best->detector : "";
}

struct Panels {
  Blocks times, speedups;  // ms; ratio
};

void add_cpu(Panels& f, const Device& d) {
  const auto serial = points(d, at("serial_multi_cell", "paper")), levels = points(d, at("serial_levels", "best")),
             parallel = points(d, at("parallel_levels", "best"));
  const std::string who = d.has_gpu() ? short_name(d) + "'s host" : short_name(d);
  add(f.times, fmt::format("serial multi-cell, 1 cm ({})", who), kSerialPaper, serial);
  add(f.times, fmt::format("serial levels ({})", who), kSerialBest, levels);
  add(f.times, fmt::format("parallel levels, {} cores ({})", d.cores, who), kParallel, parallel);
  if (d.has_gpu()) return;
  add(f.speedups, "serial levels over serial multi-cell, 1 cm", kSerialBest, ratio(serial, levels));
  add(f.speedups, fmt::format("parallel levels, {} cores, over serial multi-cell, 1 cm", d.cores), kParallel,
      ratio(serial, parallel));
}

void add_gpu(Panels& f, const Device& d, std::size_t index) {
  const int look = kFirstGpu + kLooksAGpu * static_cast<int>(index % kMostGpus);
  const auto paper = points(d, at("multi_cell_bucket/paper", "paper"));
  const std::string fastest = fastest_gpu_detector(d), name = short_name(d);
  const auto best = points(d, at(fastest, "best"));
  add(f.times, fmt::format("{}, paper's method, 1 cm", name), look + kAsPublished, paper);
  add(f.times, fmt::format("{}, {} at its best", name, fastest), look + kAtItsBest, best);
  add(f.speedups, fmt::format("{}, paper's method over serial multi-cell, both 1 cm", name), look + kAsPublished,
      ratio(points(d, at("serial_multi_cell", "paper")), paper));
  add(f.speedups, fmt::format("{}, {} over serial levels", name, fastest), look + kOverSerial,
      ratio(points(d, at("serial_levels", "best")), best));
  add(f.speedups, fmt::format("{}, {} over parallel levels, {} cores", name, fastest, d.cores), look + kOverParallel,
      ratio(points(d, at("parallel_levels", "best")), best));
}

Figure assemble(Panels panels, const std::vector<const Device*>& gpus, const std::vector<Device>& devices) {
  Figure f{
      "figure8", "Figure 8: time for contact detection against the number of balls, and speed-ups, at cell factor 4", {}, {}};
  std::string missing;
  if (gpus.empty()) missing = "a GPU of today: not measured";
  if (devices.empty()) missing += "; a CPU of today: not measured";
  for (std::size_t k = kMostGpus; k < gpus.size(); ++k) missing += fmt::format("; {}: see its table", gpus[k]->label);
  if (missing.rfind("; ", 0) == 0) missing.erase(0, 2);
  // Published times have no quartiles, nor have ratios.
  const auto published = static_cast<std::size_t>(
      std::count_if(panels.times.begin(), panels.times.end(), [](const Block& b) { return b.look <= kPaperGtx580; }));
  const std::size_t speedups = panels.speedups.size();
  auto panel = [&](const std::string& id, const std::string& title, const std::string& alt, Blocks blocks,
                   std::size_t quartiles_from) {
    f.panels.push_back({id,
                        "figure8.gp",
                        alt,
                        std::move(blocks),
                        {{"panel_title", in_quotes(title)},
                         {"missing", in_quotes(missing)},
                         {"quartiles_from", std::to_string(quartiles_from)}}});
  };
  panel("figure8_time", "time for contact detection (ms)", "time in ms against the number of balls, both axes logarithmic",
        std::move(panels.times), published + 1);
  panel("figure8_speedup", "speed-up (ratio of times; the base is named)",
        "ratio of times against the number of balls, both axes logarithmic", std::move(panels.speedups), speedups + 1);
  if (!missing.empty()) f.notes.push_back("Not shown: " + missing + ".");
  f.notes.push_back(
      "Medians with quartiles; ball_lists, stream launch, hot cache. Grey and open: published values. A speed-up over a CPU "
      "method "
      "is over that method on the same machine; its absolute time stands in Table 2 and, for one host, on the left.");
  return f;
}

}  // namespace

Figure figure8(const Published& published, const std::vector<Device>& devices) {
  Panels f;
  const auto cpu = published_points(published.rows, "CPU"), old_gpu = published_points(published.rows, "GTX285"),
             gpu = published_points(published.rows, "GTX580");
  add(f.times, "CPU, published 2012", kPaperCpu, cpu);
  add(f.times, "GTX285, published", kPaperGtx285, old_gpu);
  add(f.times, "GTX580, published", kPaperGtx580, gpu);
  add(f.speedups, "GTX285 over CPU, published", kPaperGtx285, ratio(cpu, old_gpu));
  add(f.speedups, "GTX580 over CPU, published", kPaperGtx580, ratio(cpu, gpu));
  std::vector<const Device*> gpus;
  for (const Device& d : devices)
    if (d.has_gpu()) gpus.push_back(&d);
  // One host's CPU series in full: two would not be told apart. A GPU's own host, if there is one, since its speed-ups rest on
  // it.
  if (!gpus.empty())
    add_cpu(f, *gpus.front());
  else if (!devices.empty())
    add_cpu(f, devices.front());
  for (std::size_t k = 0; k < gpus.size() && k < kMostGpus; ++k) add_gpu(f, *gpus[k], k);
  // Whoever measured a CPU here looks for it, and one line of it can be told apart.
  for (const Device& d : devices)
    if (d.local && !d.has_gpu() && !gpus.empty())
      add(f.times, fmt::format("serial levels, this machine ({})", short_name(d)), kThisMachine,
          points(d, at("serial_levels", "best")));
  return assemble(std::move(f), gpus, devices);
}

}  // namespace touchstone::report
