// `retarget certify`: measures, simulates and predicts one motion, in one document.

#include "arguments.h"
#include "commands.h"
#include "console.h"
#include "measure_files.h"
#include "retarget/certificate.h"
#include "retarget/check_options.h"
#include "retarget/file.h"
#include "retarget/measure_files.h"
#include "retarget/run.h"
#include "retarget/text.h"
#include "retarget/try.h"

namespace retarget::cli {

Result<ExitCode> certify(const CertifyArguments& arguments, Console& console) {
  RETARGET_TRY(check_robot_choice(arguments.run.run.robot));
  RETARGET_TRY_ASSIGN(const auto read, check_inputs(arguments));
  if (arguments.motions.size() != 1) return usage_failure("a certificate describes one motion");
  const std::string output =
      arguments.output.empty() ? certificate_file(arguments.motions.front()) : arguments.output;
  RETARGET_TRY(check_written({output, arguments.run.request.write_map}, read));
  RETARGET_TRY_ASSIGN(const MeasureRequest request, measure_request(arguments));
  const InterruptGuard guard;
  RETARGET_TRY_ASSIGN(const Certificate certificate, retarget::certify(request, console));
  RETARGET_TRY(write_file(output, certificate.json));
  console.lines(verdict_lines(certificate.report));
  console.line("simulation", certificate.fell ? "the robot falls" : "no fall");
  if (certificate.predicted_success >= 0.0) {
    console.line("predicted", number_text(certificate.predicted_success, 2) +
                                  ": predicted probability of tracking without a fall");
  }
  console.line("wrote", output == "-" ? "standard output" : output);
  return certificate.passed() ? kDone : kRunFailed;
}

}  // namespace retarget::cli
