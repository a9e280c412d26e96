// GPUs of 2012 and of today side by side: times, and times in units of what each card could have done meanwhile.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/figure.h"
#include "bench/report/results.h"
#include "bench/report/table.h"

namespace touchstone::report {

// Theoretical figures of one card, from results/cards.json.
struct Card {
  std::string name;
  std::string paper_column;  // of Table 2, if it is one of the paper's: "GTX285"; two cards may be readings of one column
  std::string device_name;   // in records, if it is measured
  double gb_per_s = 0;
  double gflops = 0;                                         // FP32, cores x clock x 2
  double vendor_gflops = 0;                                  // as advertised; 0: the same
  std::string notes;                                         // how the two differ; how the paper is read
  std::vector<std::pair<std::string, std::string>> sources;  // words, address
};

// Throws InputError for a file that is not of this form; no file gives no cards.
std::vector<Card> read_cards(const std::filesystem::path& results);

// The cards' theoretical figures with sources; for measured ones how far the records' own are from them.
Table cards_table(const std::vector<Card>& cards, const std::vector<Device>& devices);

// Every card at every size: ms; kB its memory could have moved and kFLOP it could have done a ball in that time.
Table generations_table(const Published& published, const std::vector<Card>& cards, const std::vector<Device>& devices);

// The same three at the largest size that all have.
Figure generations_figure(const Published& published, const std::vector<Card>& cards, const std::vector<Device>& devices);

}  // namespace touchstone::report
