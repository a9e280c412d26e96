#include "bench/report/library.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/report/study_tables.h"
#include "bench/study.h"

namespace touchstone::report {
namespace {

// Whether a machine without a GPU can make any of a study's cases.
bool on_cpu(const std::string& study) {
  const std::vector<Case> cases = plan_study(study, {.profile = Profile::full});
  return std::any_of(cases.begin(), cases.end(), [](const Case& c) { return c.detector->place == Place::host; });
}

std::string cases_file(const Device& d) { return fmt::format("cases_{}_{}.json", d.study, id_of(d)); }

}  // namespace

Library::Library(const std::filesystem::path& results, const std::filesystem::path& local, const std::filesystem::path& out)
    : results_(results), out_(out) {
  for (const StudyInfo& s : studies()) {
    const std::string name(s.name);
    files_[name] = read_both(results, local, name);
  }
}

const std::vector<Device>& Library::of(const std::string& study) const { return files_.at(study); }

std::vector<Device> Library::all() const {
  std::vector<Device> list;
  for (const StudyInfo& s : studies())
    for (const Device& d : of(std::string(s.name))) list.push_back(d);
  return list;
}

std::vector<std::string> Library::missing(const std::string& study) const {
  const auto command = [&](bool gpu) { return fmt::format("; `{}` makes it", command_for(study, gpu)); };
  if (of(study).empty()) return {fmt::format("Not measured yet: no results/<device>/{}.json{}.", study, command(false))};
  const bool any_machine = on_cpu(study);
  std::map<std::string, std::string> known;  // id -> sentence
  for (const auto& [name, devices] : files_)
    for (const Device& d : devices)
      if (d.has_gpu() || any_machine)
        known[id_of(d)] = fmt::format("Not measured yet on {}: no {}.json{}.", d.label, study, command(d.has_gpu()));
  for (const Device& d : of(study)) known.erase(id_of(d));
  std::vector<std::string> list;
  for (const auto& [id, sentence] : known) list.push_back(sentence);
  return list;
}

std::string Library::command_for(const std::string& study, bool gpu) const {
  return fmt::format("build/{}/bench/bench_detect --study {} --profile full", gpu || !on_cpu(study) ? "gpu" : "cpu", study);
}

std::vector<Link> Library::records(const std::vector<const Device*>& devices) const {
  std::vector<Link> links;
  for (const Device* d : devices) {
    links.push_back({fmt::format("{}, {} (cases)", d->label, d->study), cases_file(*d)});
    links.push_back({"with all samples", link_to(d->file)});
  }
  return links;
}

std::vector<Link> Library::records(const std::vector<Device>& devices) const {
  std::vector<const Device*> list;
  for (const Device& d : devices) list.push_back(&d);
  return records(list);
}

Link Library::published(const std::string& name) const { return {"published", link_to(results_ / "paper" / (name + ".json"))}; }

Link Library::file(const std::string& text, const char* name) const { return {text, link_to(results_ / name)}; }

Exhibit Library::all_cases(const Device& d) const {
  Exhibit e = exhibit(cases_table(d, "cases_" + d.study, fmt::format("All cases of {} on {}", d.study, d.label)), d);
  e.folded = true;
  return e;
}

std::vector<std::pair<std::string, std::string>> Library::cases_files() const {
  std::vector<std::pair<std::string, std::string>> files;
  for (const auto& [study, devices] : files_)
    for (const Device& d : devices) {
      nlohmann::json j = {{"file", d.slug + "/" + d.study + ".json"}, {"run", d.run_id}, {"cases", nlohmann::json::array()}};
      for (const Row& r : d.rows) j["cases"].push_back(r.record);
      files.emplace_back(cases_file(d), j.dump(1) + "\n");
    }
  return files;
}

std::string Library::link_to(const std::filesystem::path& file) const {
  return std::filesystem::relative(file, out_).generic_string();
}

}  // namespace touchstone::report
