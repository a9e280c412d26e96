// What sdk_sort and sorted_grid share on the host side: balls sorted by the cell of their centre, then each ball searches.
#pragma once

#include <string_view>
#include <vector>

#include "kernels/ball_search.h"
#include "kernels/detection.h"
#include "kernels/planning.h"
#include "kernels/sorted_cells.h"

namespace touchstone {

class SortedSearch : public Detector {
 public:
  // params.cell must be settled; threads that are zero become 256.
  SortedSearch(std::string_view method, const Grid& grid, const PackingFacts& facts, DetectorParams params, Stream& stream)
      : params_(with_threads(method, params)),
        lanes_(lanes_a_ball(facts.n)),
        cells_(method, grid, facts.n, params_.threads_broad, stream) {}

  void detect(BallsView in, ContactsView out, Stream& stream) override {
    if (in.n == 0) return clear_count(out, stream);
    cells_.build(in, out, stream);
    stream.mark("search");
    search(cells_.view(), out, shape(in.n, out.form), lanes_, stream);
  }

  DetectorReport report(ContactsView out, Stream& stream) override { return report_output(out, stream); }
  std::int64_t workspace_bytes() const override { return cells_.bytes(); }
  DetectorParams params() const override { return params_; }
  std::vector<KernelFacts> kernels(OutputForm form) const override {
    std::vector<KernelFacts> all = cells_.kernels();
    all.push_back(search_facts(shape(1, form)));
    return all;
  }

 protected:
  // Launches the search of all balls, `lanes` threads each.
  virtual void search(CellOrderView cells, ContactsView out, LaunchShape shape, int lanes, Stream& stream) = 0;
  virtual KernelFacts search_facts(LaunchShape shape) const = 0;

 private:
  static DetectorParams with_threads(std::string_view method, DetectorParams params) {
    params.threads_broad = threads_or(method, params.threads_broad, 256);
    params.threads_narrow = threads_or(method, params.threads_narrow, 256);
    return params;
  }
  LaunchShape shape(std::int32_t n, OutputForm form) const {
    const int threads = params_.threads_narrow;
    return {blocks_for(n, threads / lanes_), threads, BallSearch::shared_bytes(form, threads, lanes_)};
  }

  DetectorParams params_;
  int lanes_;
  SortedCells cells_;
};

}  // namespace touchstone
