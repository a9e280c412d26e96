#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "peers/program.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

struct Line {
  std::string label;
  double median_us = 0, q1_us = 0, q3_us = 0;
};
struct Block {  // a packing in one order
  std::int64_t n = 0, contacts = 0;
  std::vector<Line> lines;
  std::vector<std::string> skipped;
};

std::string label_of(const Json& c) {
  std::string label = c.at("detector");
  for (const char* part : {"layout", "ablation"})
    if (c.contains(part) && c[part].is_string()) label += fmt::format("/{}", c[part].get<std::string>());
  return label;
}

std::string block_name(const Json& c) { return c.at("packing").get<std::string>() + ", " + c.at("order").get<std::string>(); }

// In the order in which they first come.
template <class T>
using Named = std::vector<std::pair<std::string, T>>;
template <class T>
T& of_name(Named<T>& all, const std::string& name) {
  const auto at = std::ranges::find(all, name, &std::pair<std::string, T>::first);
  return at != all.end() ? at->second : all.emplace_back(name, T{}).second;
}

bool is_one_of(const std::vector<std::string>& ours, const std::string& label) {
  return std::ranges::find(ours, label) != ours.end();
}

Named<Block> blocks_of(const Json& results) {
  Named<Block> blocks;
  const auto block = [&](const Json& c) -> Block& { return of_name(blocks, block_name(c)); };
  for (const Json& entry : results.at("benchmarks")) {
    if (entry.at("repetition_index") != 0) continue;  // `case` is the same on all nine
    const Json& c = entry.at("case");
    Block& b = block(c);
    b.n = c.at("n"), b.contacts = c.at("contacts");
    b.lines.push_back({label_of(c), c.at("median_us"), c.at("q1_us"), c.at("q3_us")});
  }
  for (const Json& c : results.at("context").at("touchstone").at("skipped"))
    block(c).skipped.push_back(
        fmt::format("{}: {}: {}", label_of(c), c.at("code").get<std::string>(), c.at("message").get<std::string>()));
  return blocks;
}

std::string text_of(const std::string& name, Block block, const std::vector<std::string>& ours) {
  std::ranges::stable_sort(block.lines, {}, &Line::median_us);
  const auto is_ours = [&](const Line& line) { return is_one_of(ours, line.label); };
  const auto base = std::ranges::find_if(block.lines, is_ours);
  const auto peer = std::ranges::find_if_not(block.lines, is_ours);
  std::string text = fmt::format("{}: {} balls, {} contacts\n", name, block.n, block.contacts);
  if (!block.lines.empty())
    text += fmt::format("  {:<24} {:>11} {:>11} {:>11} {:>10} {:>8}\n", "", "median ms", "q1", "q3", "Mball/s", "ratio");
  for (const Line& line : block.lines) {
    const std::string ratio = base == block.lines.end() ? "-" : fmt::format("{:.2f}", line.median_us / base->median_us);
    text += fmt::format("  {:<24} {:>11.4f} {:>11.4f} {:>11.4f} {:>10.1f} {:>8}\n", line.label, line.median_us / 1e3,
                        line.q1_us / 1e3, line.q3_us / 1e3, static_cast<double>(block.n) / line.median_us, ratio);
  }
  for (const std::string& why : block.skipped) text += fmt::format("  no time: {}\n", why);
  if (base != block.lines.end() && peer != block.lines.end())
    text += fmt::format("  {}, the best peer, takes {:.2f} times as long as {}\n", peer->label, peer->median_us / base->median_us,
                        base->label);
  return text;
}

// A detector's line of kernel_table().
struct BusyLine {
  std::string label;
  int kernels, transfers;
  double kernels_us, transfers_us, busy_us;
};

std::string busy_text(std::vector<BusyLine> lines, const std::vector<std::string>& ours) {
  std::ranges::stable_sort(lines, {}, &BusyLine::busy_us);
  const auto base = std::ranges::find_if(lines, [&](const BusyLine& line) { return is_one_of(ours, line.label); });
  std::string text = fmt::format("  {:<24} {:>9} {:>9} {:>11} {:>11} {:>11} {:>8}\n", "", "kernels", "copies", "kernels ms",
                                 "copies ms", "busy ms", "ratio");
  for (const BusyLine& line : lines)
    text += fmt::format("  {:<24} {:>9} {:>9} {:>11.4f} {:>11.4f} {:>11.4f} {:>8}\n", line.label, line.kernels, line.transfers,
                        line.kernels_us / 1e3, line.transfers_us / 1e3, line.busy_us / 1e3,
                        base == lines.end() ? "-" : fmt::format("{:.2f}", line.busy_us / base->busy_us));
  return text;
}

}  // namespace

std::string kernel_table(const Json& results, const std::vector<std::string>& ours) {
  try {
    Named<std::vector<BusyLine>> blocks;
    for (const Json& c : results.at("cases")) {
      const std::string name = fmt::format("{}: {} balls, {} contacts", block_name(c), c.at("n").get<std::int64_t>(),
                                           c.at("contacts").get<std::int64_t>());
      of_name(blocks, name)
          .push_back(
              {label_of(c), c.at("kernels"), c.at("transfers"), c.at("kernels_us"), c.at("transfers_us"), c.at("busy_us")});
    }
    std::string text;
    for (const auto& [name, lines] : blocks) text += name + "\n" + busy_text(lines, ours);
    for (const Json& c : results.at("skipped"))
      text += fmt::format("  no time: {} on {}: {}: {}\n", c.at("detector").get<std::string>(), block_name(c),
                          c.at("code").get<std::string>(), c.at("message").get<std::string>());
    return text;
  } catch (const Json::exception& e) {
    throw InputError(fmt::format("no results of bench_peers --kernels: {}", e.what()));
  }
}

std::string peer_table(const Json& results, const std::vector<std::string>& ours) {
  try {
    std::string text;
    for (const auto& [name, block] : blocks_of(results)) text += text_of(name, block, ours);
    return text;
  } catch (const Json::exception& e) {
    throw InputError(fmt::format("no results of bench_peers: {}", e.what()));
  }
}

}  // namespace touchstone
