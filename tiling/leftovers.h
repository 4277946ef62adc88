#pragma once

#include <filesystem>

#include "phases.h"

/// The output folder holds one data set.
///
/// A run into the folder of an earlier one replaces its files one by one; what the new run does not write (tiles
/// beyond its own, meshes or rasters that it was not asked for) would stay and be taken for a part of it. It goes when
/// everything else of the new data set is complete, right before the index.

namespace hydrotin {

/// Removes a file if it is there. Fails: Error(storage).
void remove_leftover(const std::filesystem::path& path);

/// Removes files with names of ours that the run does not write. Other files are left alone.
void remove_leftovers(const RunContext& context);

/// Removes pictures in the folder of profiles that are none of these; without rivers the folder goes if it is empty.
void remove_other_profiles(const RunContext& context, const std::vector<std::string>& made);

}  // namespace hydrotin
