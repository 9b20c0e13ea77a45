#include "fit_run.h"

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "base/text_size.h"
#include "batch/worker_pool.h"
#include "interrupt.h"
#include "read_source.h"

namespace retarget::cli {
namespace {

// `targets lowered by 4 cm`
std::string floor_text(const FitReport& report) {
  const std::string size = number_text(100.0 * std::abs(report.floor_height), 1);
  if (size == "0") return "targets stay at their height";
  return std::string("targets ") + (report.floor_height > 0.0 ? "lowered" : "raised") + " by " +
         size + " cm";
}

// what a fit found and what is left
void print_fit(const FitReport& report, bool verbose, Console& console) {
  for (const std::string& note : report.notes) console.line("fit", note);
  console.line("floor", floor_text(report) + (report.floor_found ? "" : " (a guess)") + ", " +
                            count_text(report.contact_phases, "contact phase"));
  for (const FitTermReport& term : report.terms) {
    if (!verbose) break;
    std::string worst;
    for (const int frame : term.worst) worst += (worst.empty() ? "" : ", ") + std::to_string(frame);
    console.line(&term == &report.terms.front() ? "costs" : "",
                 term.name + " " + number_text(term.before, 3) + " -> " +
                     number_text(term.after, 3) + (worst.empty() ? "" : ", worst in " + worst));
  }
  for (const FitBoundReport& bound : report.bounded) {
    console.line("bounded", bound.joint + " in " + count_text(bound.frames, "frame") +
                                ", most in " + std::to_string(bound.worst_frame) + " by " +
                                number_text(bound.largest, 3));
  }
}

}  // namespace

Result<FitOptions> fit_options(const RunOptions& options) {
  FitOptions fit;
  // limits hold for what is written; coarser numbers than these serve nobody
  constexpr int kFewestDecimals = 3;
  fit.decimals = std::max(kFewestDecimals, options.precision);
  if (!options.fit_config.empty()) {
    const auto file = read_file(options.fit_config, ErrorKind::kConfig, kMostTextBytes);
    if (!file) return failure(file.error());
    auto read = parse_fit_options(file->view(), options.fit_config, fit);
    if (!read) return failure(read.error());
    fit = *read;
  }
  if (fit.threads == 0) fit.threads = options.threads > 0 ? options.threads : usable_cores();
  if (options.fit_window_s > 0.0) fit.window = options.fit_window_s;
  if (auto left_out = leave_out_terms(fit, options.without); !left_out) {
    return failure(left_out.error());
  }
  return fit;
}

Result<FitResult> run_fit(const Clip& clip, const HumanSource& human,
                          const std::shared_ptr<const Robot>& robot, const ResolvedMapping& tables,
                          const LimitSet& limits, const RunOptions& options,
                          const RetargetOptions& first_stage, Console& console) {
  const auto chosen = fit_options(options);
  if (!chosen) return failure(chosen.error());
  FitRun run;
  run.retarget = first_stage;
  run.keep_going = [&](double done) {
    console.progress("fitting, percent", static_cast<int>(100.0 * done), 100);
    return !InterruptGuard::interrupted();
  };
  auto result = fit(clip, human.calibration.mapping, source_name(options.source), robot, tables,
                    limits, *chosen, run);
  console.end_progress();
  if (result) print_fit(result->report, options.verbose, console);
  return result;
}

}  // namespace retarget::cli
