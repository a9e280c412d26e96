#include "kernels/detection.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace touchstone {

ContactStorage::ContactStorage(Place place, OutputForm form, std::int32_t n, std::int64_t capacity, Stream& stream)
    : form_(form), n_(n), capacity_(capacity) {
  if (form == OutputForm::pairs) {
    pair_ = Buffer<Pair>(capacity, place, stream);
    count_ = Buffer<std::int64_t>(1, place, stream);
  } else {
    length_ = Buffer<std::int32_t>(n, place, stream);
    slot_ = Buffer<std::int32_t>(static_cast<std::size_t>(capacity) * n, place, stream);
    fill_async(slot_, 0, stream);  // download() copies all of them, also those that no contact was written to
  }
}

ContactsView ContactStorage::view() const {
  ContactsView v;
  v.form = form_;
  v.n = n_;
  if (form_ == OutputForm::pairs) {
    v.pair = pair_.data();
    v.pair_capacity = capacity_;
    v.count = count_.data();
  } else {
    v.length = length_.data();
    v.slot = slot_.data();
    v.row_capacity = static_cast<std::int32_t>(capacity_);
  }
  return v;
}

std::int64_t ContactStorage::bytes() const {
  return static_cast<std::int64_t>(pair_.bytes() + count_.bytes() + length_.bytes() + slot_.bytes());
}

ContactList ContactStorage::download(Stream& stream) const {
  if (form_ == OutputForm::pairs) {
    const std::int64_t count = touchstone::download(count_.data(), 1, stream)[0];
    return from_pairs(touchstone::download(pair_.data(), count, stream), n_);
  }
  return from_ball_lists(touchstone::download(length_.data(), length_.size(), stream),
                         touchstone::download(slot_.data(), slot_.size(), stream), static_cast<std::int32_t>(capacity_));
}

std::int64_t default_capacity(OutputForm form, const PackingFacts& facts) {
  if (form == OutputForm::pairs) return std::max<std::int64_t>(64, kDefaultPairsABall * facts.n);
  // Small balls about one large: about 0.8 * 4 * ((R + r) / r)^2 of them fit (dem_spec.md section 3).
  const double most = 3.2 * std::pow(1 + facts.cell_factor(), 2);
  const double rounded = 16 * std::ceil(std::min(most, 512.0) / 16);
  return std::min<std::int64_t>(static_cast<std::int64_t>(rounded), std::max(1, facts.n - 1));
}

DetectorReport report_output(ContactsView out, Stream& stream) {
  DetectorReport report;
  if (out.form == OutputForm::pairs) {
    report.contacts = download(out.count, 1, stream)[0];
    report.list = {-1, report.contacts, out.pair_capacity};
    return report;
  }
  const std::vector<std::int32_t> length = download(out.length, out.n, stream);
  report.contacts = std::accumulate(length.begin(), length.end(), std::int64_t{0}) / 2;
  const auto worst = std::max_element(length.begin(), length.end());
  if (worst != length.end()) report.row = {worst - length.begin(), *worst, out.row_capacity};
  return report;
}

std::string DetectorReport::text() const {
  std::string line = fmt::format("{} contacts", contacts);
  if (cell.happened()) line += fmt::format("; cell {} holds {} balls, capacity {}", cell.index, cell.count, cell.capacity);
  if (row.happened()) line += fmt::format("; ball {} has {} contacts, capacity {}", row.index, row.count, row.capacity);
  if (list.happened()) line += fmt::format("; the pair list holds {}", list.capacity);
  return line;
}

std::int64_t Detection::bytes() const {
  return static_cast<std::int64_t>(balls.bytes()) + detector->workspace_bytes() + output->bytes();
}

Detection detect_completely(const DetectorInfo& info, std::span<const Ball> balls, const PackingFacts& facts,
                            DetectorParams params, OutputForm form, Stream& stream, std::int64_t capacity) {
  Detection d;
  d.balls = Buffer<Ball>(balls.size(), info.place, stream);
  copy_async(d.balls, balls, stream);
  complete_detection(d, info, facts, params, form, stream, capacity == 0 ? default_capacity(form, facts) : capacity);
  return d;
}

void complete_detection(Detection& d, const DetectorInfo& info, const PackingFacts& facts, DetectorParams params, OutputForm form,
                        Stream& stream, std::int64_t capacity) {
  constexpr int kMostRetries = 8;
  for (;; ++d.retries) {
    if (!d.detector) d.detector = info.make(facts, params, stream);
    if (!d.output) d.output = std::make_unique<ContactStorage>(info.place, form, facts.n, capacity, stream);
    d.detector->detect(d.input(), d.output->view(), stream);
    d.report = d.detector->report(d.output->view(), stream);
    if (d.report.complete()) return;
    if (d.retries == kMostRetries)
      throw std::runtime_error(
          fmt::format("{}: still too small after {} retries: {}", info.label(), kMostRetries, d.report.text()));
    if (d.report.cell.happened()) {
      params.cell_capacity = static_cast<std::int32_t>(d.report.cell.count);
      d.detector.reset();
    }
    if (d.report.row.happened() || d.report.list.happened()) {
      capacity = std::max(d.report.row.count, d.report.list.count);
      d.output.reset();
    }
  }
}

}  // namespace touchstone
