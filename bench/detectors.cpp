#include "bench/detectors.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <numeric>
#include <regex>

#include "build_info.h"
#include "kernels/device.h"
#include "touchstone/error.h"

namespace touchstone {
namespace {

// Levenshtein's distance between two short words.
int distance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::vector<std::string> nearest_labels(std::string_view wanted) {
  std::vector<std::pair<int, std::string>> ranked;
  for (const auto rows : {cpu_detectors(), gpu_detectors()})  // also those that cannot run here: the name may just be misspelt
    for (const DetectorInfo& info : rows)
      ranked.emplace_back(std::min(distance(wanted, info.label()), distance(wanted, info.name)), info.label());
  std::sort(ranked.begin(), ranked.end());
  std::vector<std::string> labels;
  for (std::size_t k = 0; k < ranked.size() && k < 3; ++k) labels.push_back(ranked[k].second);
  return labels;
}

}  // namespace

bool gpu_usable() {
#if defined(TOUCHSTONE_HAVE_CUDA)
  return device_count() > 0;
#else
  return false;
#endif
}

std::string why_no_gpu() {
#if defined(TOUCHSTONE_HAVE_CUDA)
  int n = 0;
  const cudaError_t status = cudaGetDeviceCount(&n);
  if (status != cudaSuccess) return fmt::format("no usable GPU: {}", cudaGetErrorString(status));
  return n > 0 ? "" : "no usable GPU: the driver lists none";
#else
  return fmt::format("no GPU kernels in this build: {}", build_info::kWhyNoKernels);
#endif
}

std::vector<const DetectorInfo*> all_detectors() {
  std::vector<const DetectorInfo*> all;
  for (const DetectorInfo& info : cpu_detectors()) all.push_back(&info);
#if defined(TOUCHSTONE_HAVE_CUDA)
  if (gpu_usable())
    for (const DetectorInfo& info : gpu_detectors()) all.push_back(&info);
#endif
  return all;
}

std::vector<const DetectorInfo*> all_ablations() {
  std::vector<const DetectorInfo*> all;
#if defined(TOUCHSTONE_HAVE_CUDA)
  if (gpu_usable())
    for (const DetectorInfo& info : gpu_ablations()) all.push_back(&info);
#endif
  return all;
}

const DetectorInfo& find_detector(std::string_view label) {
  const auto is_asked = [label](const DetectorInfo& info) { return info.label() == label || info.name == label; };
  std::vector<const DetectorInfo*> same_name;
  for (const DetectorInfo* info : all_detectors()) {
    if (info->label() == label) return *info;
    if (info->name == label) same_name.push_back(info);
  }
  if (same_name.size() == 1) return *same_name[0];
  if (same_name.size() > 1) {
    std::vector<std::string> labels;
    for (const DetectorInfo* info : same_name) labels.push_back(info->label());
    throw InputError(fmt::format("detector '{}' has several layouts: say {}", label, fmt::join(labels, " or ")));
  }
  if (std::ranges::any_of(gpu_detectors(), is_asked))
    throw NoGpuError(fmt::format("detector '{}' runs on a GPU: {}", label, why_no_gpu()));
  throw InputError(fmt::format("unknown detector '{}': near are {}", label, fmt::join(nearest_labels(label), ", ")));
}

void require_gpu_if_only_gpu(const std::string& pattern) {
  if (gpu_usable()) return;
  const std::regex labels(pattern);
  const auto is_found = [&labels](const DetectorInfo& info) { return std::regex_search(info.label(), labels); };
  if (std::ranges::any_of(gpu_detectors(), is_found) && std::ranges::none_of(cpu_detectors(), is_found))
    throw NoGpuError(fmt::format("'{}' finds GPU detectors only: {}", pattern, why_no_gpu()));
}

}  // namespace touchstone
