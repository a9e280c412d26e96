#include "bench/report/cards.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "bench/report/dots.h"
#include "bench/report/marks.h"
#include "bench/strict_json.h"
#include "bench/theory.h"
#include "datasets/files.h"
#include "touchstone/error.h"

namespace touchstone::report {
namespace {

using nlohmann::json;

// Times of one way to use one card, by number of balls.
struct Line {
  std::string name;
  bool published = false;
  double gb_per_s = 0, gflops = 0;  // 0: not known
  std::map<std::int64_t, const Row*> rows;
};

Card card_of(const json& j) {
  Card c;
  c.name = j.at("name");
  c.paper_column = j.value("paper_column", "");
  c.device_name = j.value("device_name", "");
  c.gb_per_s = j.at("bandwidth_gb_per_s");
  c.gflops = 2e-3 * j.at("fp32_cores").get<double>() * j.at("clock_mhz").get<double>();
  c.vendor_gflops = j.value("vendor_gflops", 0.0);
  c.notes = j.value("vendor_note", "");
  if (const std::string reading = j.value("reading", ""); !reading.empty()) c.notes += (c.notes.empty() ? "" : "; ") + reading;
  for (const json& s : j.at("sources"))
    c.sources.emplace_back(fmt::format("{} ({})", s.at("where").get<std::string>(), s.at("what").get<std::string>()),
                           s.at("url"));
  return c;
}

double fact(const Device& d, const char* pointer) {
  const json::json_pointer at(pointer);
  return d.facts.contains(at) && d.facts.at(at).is_number() ? d.facts.at(at).get<double>() : 0;
}

// "3352.32 (0.1 % from the source)"
std::string beside(double record, double source) {
  if (!(record > 0)) return "not in the record";
  return fmt::format("{:.0f} ({:.1f} % off)", record, 100 * std::abs(record / source - 1));
}

// The paper's columns, a card with two readings twice; then of each measured card the paper's method at 1 cm, and whatever is
// fastest there at its best.
std::vector<Line> lines_of(const Published& published, const std::vector<Card>& cards, const std::vector<Device>& devices) {
  std::vector<Line> lines;
  for (const Card& c : cards) {
    if (c.paper_column.empty()) continue;
    Line l{c.name == "GTX 280" ? "GTX 285 read as GTX 280" : c.name, true, c.gb_per_s, c.gflops, {}};
    for (const Row& r : published.rows)
      if (r.device == c.paper_column) l.rows[r.n] = &r;
    lines.push_back(std::move(l));
  }
  for (const Device& d : devices) {
    if (!d.has_gpu()) continue;
    const auto card = std::find_if(cards.begin(), cards.end(), [&](const Card& c) { return c.device_name == d.gpu; });
    const double gb_per_s = fact(d, "/device/theoretical_gb_per_s"), gflops = card == cards.end() ? 0 : card->gflops;
    const std::string name = short_name(d) + (d.local ? " (this machine)" : "");
    Line papers{name + ", paper's method", false, gb_per_s, gflops, {}}, best{name + ", fastest", false, gb_per_s, gflops, {}};
    for (const Row& r : d.rows) {
      if (r.place != "gpu" || r.launch != "stream" || r.cache != "hot" || r.output != "ball_lists") continue;
      if (r.protocol == "paper" && r.detector == "multi_cell_bucket/paper") papers.rows[r.n] = &r;
      if (r.protocol != "best") continue;
      const Row*& there = best.rows[r.n];
      if (!there || r.median_us < there->median_us) there = &r;
    }
    for (Line* l : {&papers, &best})
      if (!l->rows.empty()) lines.push_back(std::move(*l));
  }
  return lines;
}

// GB/s times µs is kB; GFLOP/s times µs is kFLOP.
double kilo_a_ball(double rate, double us, std::int64_t n) { return rate * us / static_cast<double>(n); }

const std::string kMethod =
    "Ball lists, stream launch, hot cache; C = 4. Paper's method: multi_cell_bucket/paper, cell 1 cm, 256 and 128 threads. "
    "Fastest: "
    "the fastest GPU detector at its best at each size.";

}  // namespace

std::vector<Card> read_cards(const std::filesystem::path& results) {
  const std::filesystem::path path = results / "cards.json";
  if (!std::filesystem::exists(path)) return {};
  const json file = parse_strict_json(read_whole(path), path.string() + ": no JSON");
  std::vector<Card> cards;
  try {
    if (file.at("schema") != "touchstone-cards/1") throw InputError(path.string() + ": schema is not touchstone-cards/1");
    for (const json& j : file.at("cards")) cards.push_back(card_of(j));
  } catch (const json::exception& e) {
    throw InputError(fmt::format("{}: not of schema touchstone-cards/1: {}", path.string(), e.what()));
  }
  return cards;
}

Table cards_table(const std::vector<Card>& cards, const std::vector<Device>& devices) {
  Table t{"cards",
          "The cards' theoretical figures",
          {"card", "bandwidth, GB/s", "by the record", "FP32, GFLOP/s", "by the record", "as advertised"},
          {},
          {}};
  t.text_columns = t.header.size();
  for (const Card& c : cards) {
    std::string bandwidth = "published card: no record", flops = bandwidth;
    if (c.paper_column.empty()) bandwidth = flops = "not measured";
    for (const Device& d : devices)
      if (!c.device_name.empty() && d.gpu == c.device_name && !d.local) {
        bandwidth = beside(fact(d, "/device/theoretical_gb_per_s"), c.gb_per_s);
        // 128 FP32 lanes a multiprocessor on compute 9.0 (CUDA C++ Programming Guide, compute capabilities).
        const bool hopper = d.facts.value(json::json_pointer("/device/compute_capability"), "") == "9.0";
        flops = hopper ? beside(256e-3 * fact(d, "/device/sms") * fact(d, "/device/max_sm_mhz"), c.gflops) : "not compared";
      }
    t.rows.push_back({c.name, number_text(c.gb_per_s), bandwidth, fmt::format("{:.0f}", c.gflops), flops,
                      c.vendor_gflops > 0 ? fmt::format("{:.0f}", c.vendor_gflops) : "the same"});
    for (const auto& [words, url] : c.sources) t.notes.push_back(fmt::format("{}: {}, {}", c.name, words, url));
    if (!c.notes.empty()) t.notes.push_back(c.name + ": " + c.notes + ".");
  }
  t.notes.push_back(
      "FP32: cores x clock x 2 for every card. By the record: memory clock and bus width; multiprocessors x 128 x 2 x "
      "greatest clock.");
  return t;
}

Table generations_table(const Published& published, const std::vector<Card>& cards, const std::vector<Device>& devices) {
  Table t{
      "generations", "The same task on GPUs of 2012 and of today, and what each card could have done in that time", {}, {}, {}};
  t.header = {"card", "quantity"};
  t.text_columns = 2;
  const std::vector<Line> lines = lines_of(published, cards, devices);
  std::set<std::int64_t> sizes;
  for (const Line& l : lines)
    for (const auto& [n, row] : l.rows) sizes.insert(n);
  for (const std::int64_t n : sizes) t.header.push_back(with_commas(n));
  for (const Line& l : lines) {
    const std::string name = l.name + (l.published ? " (published)" : "");
    const auto add = [&](const char* quantity, double rate) {
      std::vector<std::string> cells{name, quantity};
      for (const std::int64_t n : sizes) {
        const auto at = l.rows.find(n);
        cells.push_back(at == l.rows.end() ? "not measured"
                        : rate > 0         ? three_digits(kilo_a_ball(rate, at->second->median_us, n)) + at->second->marks
                                           : "unknown card");
      }
      t.rows.push_back(std::move(cells));
    };
    std::vector<std::string> times{name, "ms"};
    std::map<std::string, std::string> which;  // detector -> sizes
    for (const std::int64_t n : sizes) {
      const auto at = l.rows.find(n);
      const Row* r = at == l.rows.end() ? nullptr : at->second;
      times.push_back(!r ? "not measured" : r->printed.empty() ? three_digits(1e-3 * r->median_us) + r->marks : r->printed);
      if (r && r->protocol == "best") which[r->detector] += (which[r->detector].empty() ? "" : "; ") + with_commas(n);
    }
    t.rows.push_back(std::move(times));
    for (const auto& [detector, at] : which) t.notes.push_back(fmt::format("{}: {} at {}.", l.name, detector, at));
    add("time x bandwidth, kB a ball", l.gb_per_s);
    add("time x FP32, kFLOP a ball", l.gflops);
  }
  t.notes.insert(
      t.notes.begin(),
      {kMethod,
       "Time x bandwidth: what the card's memory could have moved meanwhile; time x FP32: what its cores could have computed. "
       "Less is a better use of the card. Bandwidth of measured cards: their records'."});
  for (const std::string& note : notes_for(t.rows)) t.notes.push_back(note);
  return t;
}

Figure generations_figure(const Published& published, const std::vector<Card>& cards, const std::vector<Device>& devices) {
  Figure f{"generations_figure", "", {}, {}};
  std::vector<Line> lines = lines_of(published, cards, devices);
  if (lines.empty() || published.rows.empty()) return f;
  const std::int64_t n =
      std::max_element(published.rows.begin(), published.rows.end(), [](const Row& a, const Row& b) { return a.n < b.n; })->n;
  std::erase_if(lines, [&](const Line& l) { return !l.rows.contains(n); });
  f.caption =
      fmt::format("GPUs of 2012 and of today at {} balls: time, and what each card could have done in that time", with_commas(n));
  struct Quantity {
    const char *id, *title, *axis;
    double Line::*rate;  // null: the time itself
  };
  const Quantity quantities[] = {{"time", "time", "ms", nullptr},
                                 {"bytes", "time x theoretical bandwidth", "kB a ball", &Line::gb_per_s},
                                 {"flops", "time x theoretical FP32", "kFLOP a ball", &Line::gflops}};
  for (const Quantity& q : quantities) {
    DotPlot plot{fmt::format("generations_{}", q.id), fmt::format("{} ({})", q.title, q.axis), q.axis, {}, {}, true, NAN, ""};
    Dots old{"published", 1, {}}, today{"measured", 2, {}};
    for (const Line& l : lines) {
      const Row& r = *l.rows.at(n);
      const auto value = [&](double us) { return q.rate ? kilo_a_ball(l.*q.rate, us, n) : 1e-3 * us; };
      if (q.rate && !(l.*q.rate > 0)) continue;
      plot.rows.push_back(l.name);
      const bool exact = l.published;
      (l.published ? old : today)
          .points.push_back({plot.rows.size() - 1, value(r.median_us), exact ? NAN : value(r.q1_us), exact ? NAN : value(r.q3_us),
                             three_digits(value(r.median_us)) + r.marks});
      if (const auto at = r.record.find("contacts"); q.rate == &Line::gb_per_s && at != r.record.end() && at->is_number()) {
        const auto bytes = theory::compulsory_bytes(n, at->get<std::int64_t>(), OutputForm::ball_lists);
        plot.reference = 1e-3 * static_cast<double>(bytes) / static_cast<double>(n);
        plot.reference_name = fmt::format("compulsory, {}", three_digits(plot.reference));
      }
    }
    plot.series = {old, today};
    f.panels.push_back(panel_of(plot));
  }
  f.notes = {kMethod,
             "Logarithmic axes; medians with quartiles, published values as printed. GTX 285 and 580 are the paper's values."};
  return f;
}

}  // namespace touchstone::report
