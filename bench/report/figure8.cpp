#include "bench/report/figure8.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "datasets/files.h"

namespace touchstone::report {
namespace {

// Numbers that plots/figure8.gp gives colour, dash and marker.
enum Style { kPaperCpu = 1, kPaperGtx285, kPaperGtx580, kSerialPaper, kSerialBest, kParallel, kGpuPaper, kGpuBest, kThisMachine };

Query at(const std::string& detector, const std::string& protocol, const std::string& launch = "stream") {
  return {detector, protocol, launch, "hot", "ball_lists", 0};
}

std::vector<Point> points(const Device& d, Query q) {
  std::vector<Point> list;
  for (const Row& r : d.rows) {
    q.n = r.n;
    if (find(d.rows, q) == &r) list.push_back({static_cast<double>(r.n), 1e-3 * r.median_us});
  }
  return list;
}

std::vector<Point> published_points(const std::vector<Row>& rows, const std::string& device) {
  std::vector<Point> list;
  for (const Row& r : rows)
    if (r.device == device) list.push_back({static_cast<double>(r.n), 1e-3 * r.median_us});
  return list;
}

std::vector<Point> ratio(const std::vector<Point>& base, const std::vector<Point>& time) {
  std::vector<Point> list;
  for (const Point& b : base)
    for (const Point& t : time)
      if (b.n == t.n) list.push_back({b.n, b.value / t.value});
  return list;
}

void add(std::vector<Series>& panel, std::string label, int style, std::vector<Point> list) {
  if (!list.empty()) panel.push_back({std::move(label), style, std::move(list)});
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

// "NVIDIA H100 80GB HBM3" -> "H100": enough for a legend.
std::string short_name(const Device& d) {
  std::string name = d.has_gpu() ? d.gpu : d.cpu;
  for (const std::string word : {"NVIDIA ", "(R)", "(TM)"})
    for (auto place = name.find(word); place != std::string::npos; place = name.find(word)) name.erase(place, word.size());
  return d.has_gpu() ? name.substr(0, name.find(' ')) : name;
}

void add_cpu(Figure8& f, const Device& d) {
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

void add_gpu(Figure8& f, const Device& d) {
  const auto paper = points(d, at("multi_cell_bucket/paper", "paper"));
  const std::string fastest = fastest_gpu_detector(d), name = short_name(d);
  const auto best = points(d, at(fastest, "best"));
  add(f.times, fmt::format("{}, paper's method, 1 cm", name), kGpuPaper, paper);
  add(f.times, fmt::format("{}, {} at its best", name, fastest), kGpuBest, best);
  add(f.speedups, fmt::format("{}, paper's method over serial multi-cell, both 1 cm", name), kGpuPaper,
      ratio(points(d, at("serial_multi_cell", "paper")), paper));
  add(f.speedups, fmt::format("{}, {} over serial levels", name, fastest), kSerialBest,
      ratio(points(d, at("serial_levels", "best")), best));
  add(f.speedups, fmt::format("{}, {} over parallel levels, {} cores", name, fastest, d.cores), kParallel,
      ratio(points(d, at("parallel_levels", "best")), best));
}

std::string data_text(const std::vector<Series>& panel) {
  std::string text = "# n value; one block a series\n";
  for (const Series& s : panel) {
    text += fmt::format("\"{}\"\n", s.label);
    for (const Point& p : s.points) text += fmt::format("{} {:.6g}\n", p.n, p.value);
    text += "\n\n";
  }
  return text;
}

bool run(const std::string& command) { return std::system(command.c_str()) == 0; }

std::string quoted(const std::filesystem::path& path) {
  std::string text = "'";
  for (const char c : path.string()) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return text + "'";
}

}  // namespace

Figure8 figure8(const Published& published, const std::vector<Device>& devices) {
  Figure8 f;
  const auto cpu = published_points(published.rows, "CPU"), old_gpu = published_points(published.rows, "GTX285"),
             gpu = published_points(published.rows, "GTX580");
  add(f.times, "CPU, published 2012", kPaperCpu, cpu);
  add(f.times, "GTX285, published", kPaperGtx285, old_gpu);
  add(f.times, "GTX580, published", kPaperGtx580, gpu);
  add(f.speedups, "GTX285 over CPU, published", kPaperGtx285, ratio(cpu, old_gpu));
  add(f.speedups, "GTX580 over CPU, published", kPaperGtx580, ratio(cpu, gpu));
  const auto with_gpu = std::find_if(devices.begin(), devices.end(), [](const Device& d) { return d.has_gpu(); });
  // One host's CPU series in full: two would not be told apart. A GPU's own host, if there is one, since its speed-ups rest on
  // it.
  if (with_gpu != devices.end())
    add_cpu(f, *with_gpu);
  else if (!devices.empty())
    add_cpu(f, devices.front());
  for (const Device& d : devices)
    if (d.has_gpu()) add_gpu(f, d);
  // Whoever measured a CPU here looks for it, and one line of it can be told apart.
  for (const Device& d : devices)
    if (d.local && !d.has_gpu() && with_gpu != devices.end())
      add(f.times, fmt::format("serial levels, this machine ({})", short_name(d)), kThisMachine,
          points(d, at("serial_levels", "best")));
  if (with_gpu == devices.end()) f.missing.push_back("a GPU of today: not measured");
  if (devices.empty()) f.missing.push_back("a CPU of today: not measured");
  return f;
}

void write_figure8_data(const Figure8& f, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  write_atomically(folder / "figure8_time.dat", data_text(f.times));
  write_atomically(folder / "figure8_speedup.dat", data_text(f.speedups));
  std::string text = "# written by `touchstone report` for plots/figure8.gp\n";
  auto styles = [&](const char* name, const std::vector<Series>& panel) {
    text += fmt::format("{}_count = {}\n{}_styles = \"", name, panel.size(), name);
    for (const Series& s : panel) text += fmt::format("{} ", s.style);
    text += "\"\n";
  };
  styles("time", f.times);
  styles("speedup", f.speedups);
  std::string missing;
  for (const std::string& m : f.missing) missing += (missing.empty() ? "" : "; ") + m;
  text += fmt::format("missing = \"{}\"\n", missing);
  write_atomically(folder / "figure8_series.gp", text);
}

std::string draw_figure8(const std::filesystem::path& script, const std::filesystem::path& folder) {
  const std::filesystem::path svg = folder / "figure8.svg";
  if (!run(fmt::format("gnuplot -e \"folder='{}'\" {}", folder.string(), quoted(script))))
    return "figure 8 was not drawn: gnuplot (package gnuplot-nox) failed or is absent; its data are written";
  // A fixed date inside: the same input must give the same bytes.
  const std::string convert = "SOURCE_DATE_EPOCH=0 rsvg-convert ";
  if (!run(convert + "-f pdf -o " + quoted(folder / "figure8.pdf") + " " + quoted(svg)) ||
      !run(convert + "-f png -w 1800 -b white -o " + quoted(folder / "figure8.png") + " " + quoted(svg)))
    return "figure8.png and .pdf were not drawn: rsvg-convert (package librsvg2-bin) failed or is absent";
  return "";
}

}  // namespace touchstone::report
