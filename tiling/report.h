#pragma once

#include <string>

#include "hydrotin/pipeline.h"
#include "phases.h"

/// What remains of a run for people: figures as JSON and text.

namespace hydrotin {

/// The figures at the end of report.json. Fails: Error(storage).
[[nodiscard]] DatasetSummary read_report(const std::string& path);

/// Whether everything that the options ask for lies in the output folder.
[[nodiscard]] bool outputs_are_present(const RunContext& context);

}  // namespace hydrotin
