#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

namespace palpate::data {

/// The Brain Imaging Data Structure a dataset is written to.
inline constexpr const char* kBidsVersion = "1.9.0";

/// A BIDS dataset (bids-specification.readthedocs.io, 1.9.0: the first with Motion-BIDS).
/// tests/data/export_clients_test.cpp runs bids-validator over it where one is installed.
///
/// - beh (behavioral experiments, no neural recordings): a _beh.tsv a session and study with one
///   row an attempt, its .json says what the columns are. Covered by the standard; the columns are
///   ours.
/// - motion, with traces: HIP as POS channels of the tracked point "handle", LATENCY from the
///   servo's clock, all else of a tick as MISC with units; one _motion.tsv, _channels.tsv and .json
///   a run, a run is an attempt. Covered; that forces of rendering are MISC is our choice, there is
///   no channel type for them.
/// - stim, with traces: the commanded force as _recording-force_stim.tsv.gz in beh/, with the run
///   of the motion. What a force is the standard does not say. Later versions give stim a place in
///   motion/ too, which validators of 1.9 refuse.
/// - A tick that was lost is a row of n/a, in motion and stim alike, so that row k is tick k.
/// - Wall clock is left out, so there is no scans.tsv. Pictures and plan have no place in the
///   standard: they are in the rows of _beh.tsv as far as they were presented.
/// - With traces of two intervals of a trial, the run is "0012" for the first and its acq is
///   "interval2" for the second.
void export_bids(Database& database,
                 const Selection& selection,
                 const ExportOptions& options,
                 const std::filesystem::path& folder);

}  // namespace palpate::data
