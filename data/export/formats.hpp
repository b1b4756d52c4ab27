#pragma once

#include <filesystem>

#include "data/export/selection.hpp"

/// Every form of an export but the plain tables. Each writes into a folder that is there and empty.
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
void export_bids(const Exporting& to);

/// A Psych-DS dataset (psych-ds.github.io; the schema of psychds-validator 1.4):
/// dataset_description.json (schema.org's Dataset as JSON-LD, all columns as variableMeasured),
/// data/description-participants_data.csv and data/study-X_subject-NNN_session-N_data.csv, one row
/// an attempt; with traces also
/// data/study-X_subject-NNN_session-N_trial-NNNN_description-ticks_data.csv, uncompressed, since
/// the standard has CSV only.
void export_psych_ds(const Exporting& to);

// ------------------------------------------------- answers as other programs of the field take them
// With a README.txt that says how. Kinds of sessions stay apart.

/// quickpsy.csv for the package of R (D. Linares, J. Lopez-Moliner, R Journal 8:122, 2016):
/// participant, study, kind, condition, x, k, n; k of n answers at x were yes, or the comparison.
/// Main trials that count.
/// @throws std::invalid_argument if there is no answer on a graded stimulus
void export_quickpsy(const Exporting& to);

/// The same counts for psignifit 4: a file without head for each participant and condition, lines
/// of x,k,n, and index.csv: which file is whose. @throws as export_quickpsy
void export_psignifit(const Exporting& to);

/// A file a session with the columns of PsychoPy's wide CSV: a row an answer in the order given,
/// practice and answers that do not count too (column counts). trials.thisN counts the rows from 0,
/// trials.thisIndex is the place in the plan, trials.thisRepN says how often that place was tried
/// before, key_resp.keys what was answered, key_resp.rt in s. No PsychoPy has read them here.
void export_psychopy(const Exporting& to);

}  // namespace palpate::data
