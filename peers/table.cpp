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

// Blocks in the order in which they first come.
std::vector<std::pair<std::string, Block>> blocks_of(const Json& results) {
  std::vector<std::pair<std::string, Block>> blocks;
  const auto block = [&](const Json& c) -> Block& {
    const auto at = std::ranges::find(blocks, block_name(c), &std::pair<std::string, Block>::first);
    return at != blocks.end() ? at->second : blocks.emplace_back(block_name(c), Block{}).second;
  };
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
  const auto is_ours = [&](const Line& line) { return std::ranges::find(ours, line.label) != ours.end(); };
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

}  // namespace

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
