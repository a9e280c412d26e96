// From Google Benchmark's runs to a touchstone/1 file (design.md, "Results schema").
#pragma once

#include <benchmark/benchmark.h>

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "bench/case.h"
#include "bench/journal.h"

namespace touchstone {

// What one case hands to the reporter besides Google Benchmark's own times.
struct CaseRecord {
  std::string journal_key;
  Json identity;     // who it is, should it be skipped
  Json case_object;  // null until measured
  std::vector<double> samples_us;
};

// A results file while it grows. Entries keep the order of `order`.
class ResultsFile {
 public:
  ResultsFile(std::filesystem::path path, Json touchstone_context)
      : path_(std::move(path)), touchstone_(std::move(touchstone_context)) {}

  void set_context(Json google_context) { google_ = std::move(google_context); }
  Json& touchstone() { return touchstone_; }
  void add(const std::string& name, Json entries) { entries_[name] = std::move(entries); }
  void skip(Json identity, const std::string& code, const std::string& message);
  std::size_t cases() const { return entries_.size(); }
  std::size_t skipped() const { return skipped_.size(); }
  const Json& skipped_cases() const { return skipped_; }

  // Samples of all cases, or of those with this flag.
  std::size_t samples(const std::string& flag = {}) const;

  // Writes the whole file atomically, entries in the order of `names`. Never a row of a skipped case.
  void write(const std::vector<std::string>& names) const;

 private:
  std::filesystem::path path_;
  Json touchstone_, google_ = Json::object(), skipped_ = Json::array();
  std::map<std::string, Json> entries_;
};

// ReportRuns arrives once a case with all its repetitions: only runs without error go through Google's own JSONReporter; its
// entries get `case` (and `samples_us` on repetition 0), go to the journal and into the file.
class Reporter : public benchmark::BenchmarkReporter {
 public:
  Reporter(ResultsFile& file, Journal& journal, std::map<std::string, CaseRecord>& records, std::vector<std::string> order,
           std::function<void()> finish)
      : file_(file), journal_(journal), records_(records), order_(std::move(order)), finish_(std::move(finish)) {}

  bool ReportContext(const Context&) override;
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override {
    finish_();  // what is known only at the end: state, completeness
    file_.write(order_);
  }

 private:
  ResultsFile& file_;
  Journal& journal_;
  std::map<std::string, CaseRecord>& records_;
  std::vector<std::string> order_;
  std::function<void()> finish_;
};

// The message of a run that was stopped by Ctrl-C: neither measured nor skipped.
inline constexpr const char* kInterruptedMessage = "interrupted";

}  // namespace touchstone
