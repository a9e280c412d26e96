// The results folders as the page's sections ask for them: a study's files, what is missing of it, and links to records.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/report/page.h"
#include "bench/report/results.h"

namespace touchstone::report {

class Library {
 public:
  // Reads every study (bench/study.h) of both folders; `local` may be empty. Links are relative to `out`. Throws InputError.
  Library(const std::filesystem::path& results, const std::filesystem::path& local, const std::filesystem::path& out);

  const std::vector<Device>& of(const std::string& study) const;
  std::vector<Device> all() const;  // every file, study by study
  const std::filesystem::path& results() const { return results_; }

  // One sentence a machine that has other results and could have this study, or one for all; none if all is there.
  std::vector<std::string> missing(const std::string& study) const;

  // The command that makes a study's file, or makes it anew: by the build for GPUs where `gpu`, or where it needs one.
  std::string command_for(const std::string& study, bool gpu) const;
  std::string command_for(const Device& device) const { return command_for(device.study, device.has_gpu()); }

  std::vector<Link> records(const std::vector<const Device*>& devices) const;
  std::vector<Link> records(const std::vector<Device>& devices) const;
  Link published(const std::string& name) const;               // results/paper/<name>.json
  Link file(const std::string& text, const char* name) const;  // results/<name>

  // An exhibit of a table or a figure.
  template <class What>
  Exhibit exhibit(What what, std::vector<Link> data, std::string refute) const {
    Exhibit e;
    if constexpr (std::is_same_v<What, Table>)
      e.table = std::move(what);
    else
      e.figure = std::move(what);
    e.data = std::move(data);
    e.refute = std::move(refute);
    return e;
  }
  // The same, of one device's file.
  template <class What>
  Exhibit exhibit(What what, const Device& device) const {
    return exhibit(std::move(what), records({&device}), command_for(device));
  }
  // The table of all cases of a file, folded.
  Exhibit all_cases(const Device& device) const;

  // {name, content} of the files of cases that records() links to: small enough to open in a browser, without samples.
  std::vector<std::pair<std::string, std::string>> cases_files() const;

 private:
  std::string link_to(const std::filesystem::path& file) const;

  std::filesystem::path results_, out_;
  std::map<std::string, std::vector<Device>> files_;
};

}  // namespace touchstone::report
