#include "bench/report/contents.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

#include "bench/report/figure6.h"
#include "bench/report/figure8.h"
#include "bench/report/figure9.h"
#include "bench/report/marks.h"
#include "bench/report/study_tables.h"
#include "bench/report/tables.h"
#include "touchstone/error.h"

namespace touchstone::report {
namespace {

// The studies a results folder may hold, in the page's order, and whether a machine without a GPU can make them.
struct Study {
  const char* name;
  bool on_cpu;
};
constexpr std::array<Study, 8> kStudies{{{"table2", true},
                                         {"figure6", false},
                                         {"figure7", true},
                                         {"equations", true},
                                         {"figure9", false},
                                         {"table3", false},
                                         {"ablation", false},
                                         {"fairness", false}}};

const Study& study_called(const std::string& name) {
  return *std::find_if(kStudies.begin(), kStudies.end(), [&](const Study& s) { return s.name == name; });
}

// The command that makes a study's file, or makes it anew: with the build for GPUs where one is meant.
std::string command_for(const Study& s, bool gpu) {
  return fmt::format("build/{}/bench/bench_detect --study {} --profile full", gpu || !s.on_cpu ? "gpu" : "cpu", s.name);
}
std::string command_for(const Device& d) { return command_for(study_called(d.study), d.has_gpu()); }

std::string cases_file(const Device& d) { return fmt::format("cases_{}_{}.json", d.study, id_of(d)); }

// Builds the sections one after another; holds what they share.
class Builder {
 public:
  explicit Builder(const Sources& sources) : sources_(sources) {
    for (const Study& s : kStudies)
      for (Device& d : read_both(sources.results, sources.local, s.name)) files_[s.name].push_back(std::move(d));
  }

  Contents build() {
    Page& page = contents_.page;
    page.title = "Touchstone: report";
    page.text = {
        "Contact detection between spheres: the tables and figures of Zheng, An and Huang, GPU-based parallel algorithm for "
        "particle "
        "contact detection (Computers and Structures 112-113, 2012), and what was measured since. Every number on this page "
        "comes from "
        "a record that it links to; published values are called published, everything else was measured and its contact set "
        "verified."};
    page.sections = {claims(),    packings(), sizes(),     cell_sweep("figure6"), cell_sweep("figure7"),
                     equations(), threads(),  occupancy(), plain("ablation"),     plain("fairness"),
                     machines()};
    for (const auto& [study, devices] : files_)
      for (const Device& d : devices) contents_.files.emplace_back(cases_file(d), cases_json(d));
    return std::move(contents_);
  }

 private:
  const std::vector<Device>& of(const std::string& study) { return files_[study]; }

  // The cases alone, without samples: small enough to open in a browser.
  std::string cases_json(const Device& d) const {
    nlohmann::json j = {{"file", d.slug + "/" + d.study + ".json"}, {"run", d.run_id}, {"cases", nlohmann::json::array()}};
    for (const Row& r : d.rows) j["cases"].push_back(r.record);
    return j.dump(1) + "\n";
  }

  std::string link_to(const std::filesystem::path& file) const {
    return std::filesystem::relative(file, sources_.out).generic_string();
  }
  std::vector<Link> records(const std::vector<const Device*>& devices) const {
    std::vector<Link> links;
    for (const Device* d : devices) {
      links.push_back({fmt::format("{}, {} (cases)", d->label, d->study), cases_file(*d)});
      links.push_back({"with all samples", link_to(d->file)});
    }
    return links;
  }
  std::vector<Link> records(const std::vector<Device>& devices) const {
    std::vector<const Device*> list;
    for (const Device& d : devices) list.push_back(&d);
    return records(list);
  }
  Link published(const std::string& name) const { return {"published", link_to(sources_.results / "paper" / (name + ".json"))}; }

  // Names the study's file where it is absent: for every machine that has other results and could have this one, or at all.
  std::vector<std::string> missing(const std::string& study) {
    const Study& s = study_called(study);
    const std::string command = fmt::format("; `{}` makes it", command_for(s, false));
    if (of(study).empty()) return {fmt::format("Not measured yet: no results/<device>/{}.json{}.", study, command)};
    std::map<std::string, std::string> known;  // id -> label
    for (const auto& [name, devices] : files_)
      for (const Device& d : devices)
        if (d.has_gpu() || s.on_cpu) known[id_of(d)] = d.label;
    for (const Device& d : of(study)) known.erase(id_of(d));
    std::vector<std::string> list;
    for (const auto& [id, label] : known)
      list.push_back(fmt::format("Not measured yet on {}: no {}.json{}.", label, study, command));
    return list;
  }

  Exhibit exhibit(Table table, std::vector<Link> data, const std::string& refute) const {
    Exhibit e;
    e.table = std::move(table);
    e.data = std::move(data);
    e.refute = refute;
    return e;
  }
  Exhibit exhibit(Figure figure, std::vector<Link> data, const std::string& refute) const {
    Exhibit e;
    e.figure = std::move(figure);
    e.data = std::move(data);
    e.refute = refute;
    return e;
  }
  Exhibit all_cases(const Device& d) const {
    Exhibit e = exhibit(cases_table(d, "cases_" + d.study, fmt::format("All cases of {} on {}", d.study, d.label)), records({&d}),
                        command_for(d));
    e.folded = true;
    return e;
  }

  Section claims() const {
    Section s{"claims", "The paper's claims", {}, {}, {}};
    if (!sources_.ledger) {
      s.missing = {"Not judged: the results folder holds no claims.json with the rules."};
      return s;
    }
    s.text = {
        "Each verdict follows from committed results by a rule that is data; the rule, its numbers and the command that could "
        "refute it stand in the record."};
    s.exhibits.push_back(exhibit(sources_.ledger->table, {{"claims.json", "claims.json"}}, ""));
    return s;
  }

  Section packings() const {
    Section s{"packings", "Packings: Table 1", {}, {}, {}};
    s.exhibits.push_back(exhibit(table1(sources_.results),
                                 {published("table1"), {"here", link_to(sources_.results / "expected.json")}},
                                 "build/cpu/bench/touchstone pack --set figure6 --record build/expected.json"));
    return s;
  }

  Section sizes() {
    const std::vector<Device>& devices = of("table2");
    const report::Published paper = read_published(sources_.results, "table2");
    const bool gpu = std::any_of(devices.begin(), devices.end(), [](const Device& d) { return d.has_gpu(); });
    const std::string refute = command_for(study_called("table2"), gpu);
    Section s{"sizes", "Number of balls: Table 2 and Figure 8", {}, {}, missing("table2")};
    std::vector<Link> all = records(devices);
    all.insert(all.begin(), published("table2"));
    s.exhibits.push_back(exhibit(table2(paper, devices), all, refute));
    s.exhibits.push_back(exhibit(figure8(paper, devices), all, refute));
    for (const Device& d : devices) {
      s.exhibits.push_back(exhibit(table2_best(d), records({&d}), refute));
      s.exhibits.push_back(exhibit(table2_rule(d), records({&d}), refute));
      s.exhibits.push_back(all_cases(d));
    }
    return s;
  }

  Section cell_sweep(const std::string& study) {
    const bool gpu = study == "figure6";
    Section s{study, gpu ? "Cell size on the GPU: Figure 6" : "Cell size on the CPU: Figure 7", {}, {}, missing(study)};
    for (const Device& d : of(study)) {
      Figure figure = gpu ? figure6(d) : figure7(d);
      if (figure.panels.empty())
        s.missing.push_back(
            fmt::format("{}: {}.json holds no sweep of the cell size on a {}.", d.label, study, gpu ? "GPU" : "CPU"));
      s.exhibits.push_back(exhibit(std::move(figure), records({&d}), command_for(d)));
      add_sweep_tables(s, d);
    }
    return s;
  }

  Section equations() {
    Section s{"equations", "Best cell size: equations 3 and 4", {}, {}, missing("equations")};
    for (const Device& d : of("equations")) add_sweep_tables(s, d);
    return s;
  }

  void add_sweep_tables(Section& s, const Device& d) const {
    s.exhibits.push_back(exhibit(optima_table(d, "optima_" + d.study, fmt::format("Best cell sizes, {} on {}", d.study, d.label)),
                                 records({&d}), command_for(d)));
    s.exhibits.push_back(all_cases(d));
  }

  Section threads() {
    Section s{"threads", "Threads a block: Figure 9", {}, {}, missing("figure9")};
    for (const Device& d : of("figure9")) {
      for (Figure& f : figure9(d)) s.exhibits.push_back(exhibit(std::move(f), records({&d}), command_for(d)));
      s.exhibits.push_back(all_cases(d));
    }
    return s;
  }

  Section occupancy() {
    Section s{"occupancy", "Occupancy: Table 3", {}, {}, missing("table3")};
    std::vector<Link> all = records(of("table3"));
    all.insert(all.begin(), published("table3"));
    s.exhibits.push_back(exhibit(report::table3(read_published(sources_.results, "table3"), of("table3")), all,
                                 command_for(study_called("table3"), true)));
    return s;
  }

  Section plain(const std::string& study) {
    const bool ablation = study == "ablation";
    Section s{study, ablation ? "Ablations" : "Fairness: seeds, order, knowledge, launch, cache, scale", {}, {}, missing(study)};
    for (const Device& d : of(study)) {
      if (ablation) s.exhibits.push_back(exhibit(ablation_table(d), records({&d}), command_for(d)));
      s.exhibits.push_back(all_cases(d));
    }
    return s;
  }

  Section machines() {
    std::vector<Device> all;
    for (const Study& study : kStudies)
      for (const Device& d : of(study.name)) all.push_back(d);
    Section s{"machines", "Machines, and how each number was taken", {}, {}, {}};
    for (const Mark& m : all_marks()) s.text.push_back(m.sign + " " + m.meaning);
    s.text.push_back(
        "A mark stands beside a number in tables and above a point in figures. Flags that all rows of a run share are named "
        "once, in "
        "the table of runs. Times are medians; a time is compared only with times of the same form of output.");
    s.exhibits.push_back(exhibit(devices_table(all), {}, ""));
    s.exhibits.push_back(exhibit(runs_table(all), {}, ""));
    return s;
  }

  const Sources& sources_;
  std::map<std::string, std::vector<Device>> files_;
  Contents contents_;
};

}  // namespace

Contents contents(const Sources& sources) {
  if (!std::filesystem::is_directory(sources.results / "paper"))
    throw InputError(fmt::format("{}: no folder paper/ with the published values; give --results", sources.results.string()));
  return Builder(sources).build();
}

}  // namespace touchstone::report
