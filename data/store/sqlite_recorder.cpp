#include "data/store/sqlite_recorder.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/base/refuse.hpp"
#include "engine/realtime/felt_scene.hpp"
#include "protocols/session/progress.hpp"
#include "protocols/trial/trial_scene.hpp"
#include "data/store/chain.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/reader.hpp"
#include "data/store/row.hpp"
#include "data/store/written_rows.hpp"
#include "data/trace/chunk.hpp"

namespace palpate::data {

/// An answer, and whatever else a person waits for, waits this long for the lock of another
/// program.
constexpr int kPatienceMs = 60'000;

/// Bytes that a reserve gives back at a time.
constexpr std::int64_t kPiece = 1'000'000;

int Reserve::take(std::int64_t bytes) {
    if (held_in_.get() < 0) {
        std::error_code unknown;
        const auto there = std::filesystem::canonical(file_, unknown);  // a link may lie elsewhere
        std::string name = fmt::format("{}.room-XXXXXX", unknown ? file_ : there.string());
        // No name that somebody could lay a link by.
        held_in_ = Descriptor(mkostemp(name.data(), O_CLOEXEC));
        if (held_in_.get() < 0) {
            return errno;
        }
        unlink(name.c_str());
    }
    const int error = posix_fallocate(held_in_.get(), 0, bytes);
    if (error == 0) {
        held_ = bytes;
    } else if (ftruncate(held_in_.get(), held_) != 0) {  // some of it may have been there
        return errno;
    }
    return error;
}

void Reserve::hold(std::int64_t bytes) {
    if (held_ >= bytes) {
        return;
    }
    const int error = take(bytes);
    const bool none = error == ENOSPC || error == EDQUOT;
    const bool cannot = error == EOPNOTSUPP || error == EINVAL;
    refuse_if<StoreError>(error != 0 && !none && !cannot,
                          "{}: no room for a trial could be set aside beside it: {}; check that "
                          "its folder is there and may be written",
                          file_, std::strerror(error));
    if (none || (cannot && bytes_free(file_) < bytes)) {
        throw StoreError(
            fmt::format("{}: its disk does not have the {:.0f} MB that a trial may take; free some "
                        "space, or go on with a copy on another disk. What was recorded is kept",
                        file_, static_cast<double>(bytes) * 1e-6));
    }
}

bool Reserve::give_back() {
    if (held_ == 0) {
        return false;
    }
    held_ = std::max<std::int64_t>(held_ - kPiece, 0);
    return ftruncate(held_in_.get(), held_) == 0;
}

using protocols::TrialId;
using protocols::TrialResult;

SqliteRecorder::SqliteRecorder(Database& database,
                               const protocols::Protocol& protocol,
                               std::int64_t session,
                               bool ticks)
    : database_(database),
      protocol_(protocol),
      session_(session),
      device_(next_device(database, session)),
      ticks_(ticks),
      trace_(database,
             machine_of(first_calibration(database, session)),
             engine::tick_period_ns(protocol.apparatus.rate_hz)),
      reserve_(database.file()) {
    database.wait_for_locks(kPatienceMs);
}

template <class Work>
auto SqliteRecorder::with_room(const Work& work) {
    for (;;) {
        try {
            return work();
        } catch (const DiskError&) {
            if (!reserve_.give_back()) {
                throw;
            }
        }
    }
}

TrialId SqliteRecorder::begin_trial(const protocols::PlannedTrial& planned) {
    running_ = 0;
    interval_ = 0;
    database_.require_in_place();
    if (!database_.in_memory()) {
        reserve_.hold(bytes_needed(protocol_, 1));
    }
    running_ = with_room([&] {
        Transaction all(database_);
        constexpr std::string_view kBefore =
            "SELECT count(*) FROM trial WHERE session_id = ?1 AND plan_position = ?2";
        const auto before = database_.first(kBefore, session_, planned.position).integer(0);
        const TrialId id = attempt_row(planned.position, before + 1, device_)
                               .set("session_id", session_)
                               .set("outcome", "running")
                               .set("started_utc", database_.utc_now())
                               .set("started_ns", database_.steady_now())
                               .insert(database_);
        all.commit();
        return id;
    });
    return running_;
}

void SqliteRecorder::begin_interval(TrialId trial,
                                    const protocols::Presentation& felt,
                                    const protocols::SceneConstants& scene) {
    require_running(trial);
    with_room([&] {
        Transaction all(database_);
        if (interval_ > 0) {
            trace_.write();
        }
        presentation_row(felt, scene).set("trial_id", trial).insert(database_);
        all.commit();
    });
    interval_ = static_cast<std::int64_t>(felt.interval);
    if (!ticks_) {
        return;
    }
    std::unique_ptr<engine::FeltScene> compiled(
        new engine::FeltScene(make_felt_scene(protocol_, felt)));
    compiled->restore_decay({.slip = scene.slip_decay, .heal = scene.heal_decay});
    trace_.begin(trial, interval_, std::move(compiled));
}

void SqliteRecorder::require_running(TrialId trial) const {
    refuse_if<std::logic_error>(trial != running_ || running_ == 0,
                                "trial {} is not the one that is running", trial);
}

void SqliteRecorder::append(TrialId trial, std::span<const engine::TickRecord> ticks) {
    require_running(trial);
    while (ticks_ && !ticks.empty()) {
        const std::size_t n = std::min(ticks.size(), kChunkTicks);
        trace_.add(ticks.first(n));
        ticks = ticks.subspan(n);
        if (trace_.is_full()) {
            save();
        }
    }
}

bool SqliteRecorder::save() {
    if (!trace_.has_unsaved()) {
        return true;
    }
    struct PatienceAgain {
        Database& database;
        ~PatienceAgain() { database.wait_for_locks(kPatienceMs); }
    } const afterwards{database_};
    database_.wait_for_locks(0);
    try {
        with_room([this] {
            Transaction all(database_);
            trace_.write();
            all.commit();
        });
        trace_.saved();
        return true;
    } catch (const LockedFile&) {  // an analyst holds a lock: the ticks wait here
        return false;
    }
}

void SqliteRecorder::end_trial(TrialId trial, const TrialResult& result) {
    require_running(trial);
    refuse_if<std::logic_error>(
        protocols::is_answered(result.outcome) != result.response.has_value(),
        "trial {} is {} {} an answer", trial, to_string(result.outcome),
        result.response ? "with" : "without");
    refuse_if<std::logic_error>(!result.invalid.empty() && !result.response,
                                "trial {} has no answer that could be invalid", trial);
    refuse_if<std::logic_error>(result.fault && result.outcome != protocols::Outcome::faulted,
                                "trial {} is {} with a fault", trial, to_string(result.outcome));
    with_room([&] { write_end(trial, result); });  // a try that fails leaves the ticks for another
    trace_.saved();
    running_ = 0;
    with_room([this] { database_.checkpoint(); });
}

void SqliteRecorder::write_end(TrialId trial, const TrialResult& result) {
    Transaction all(database_);
    trace_.write();
    write_result(trial, result);
    write_intervals(trial, result);
    if (result.response) {
        response_row(protocol_, *result.response).set("trial_id", trial).insert(database_);
    }
    if (result.step) {
        step_row(*result.step).set("trial_id", trial).insert(database_);
    }
    for (std::size_t i = 0; result.fault && i < result.fault->last.size(); ++i) {
        fault_row(result.fault->last[i]).set("trial_id", trial).insert(database_);
    }
    chain_trial(database_, trial);
    all.commit();
}

void SqliteRecorder::write_result(TrialId trial, const TrialResult& result) {
    Statement running =
        database_.prepare("SELECT 1 FROM trial WHERE trial_id = ?1 AND outcome = 'running'");
    Row row("trial");
    row.set("trial_id", trial)
        .set("outcome", to_string(result.outcome))
        .set("fault_cause",
             result.fault ? std::optional(to_string(result.fault->cause)) : std::nullopt)
        .set("invalid_reason",
             result.invalid.empty() ? std::nullopt : std::optional(result.invalid))
        .set("done_s", result.done_s)
        .set("done_uncertainty_s", result.done_uncertainty_s)
        .set("ended_utc", database_.utc_now());
    set_summary(row, result.summary, device_.gives_force());
    if (!running.bind(1, trial).step() || row.update(database_, {"trial_id"}) != 1) {
        throw StoreError(fmt::format("{}: trial {} was changed by another program while it ran",
                                     database_.file(), trial));
    }
}

void SqliteRecorder::write_intervals(TrialId trial, const TrialResult& result) {
    for (std::size_t i = 0; i < result.intervals.size(); ++i) {
        Row row("presentation");
        row.set("trial_id", trial)
            .set("interval", i + 1)
            .set("done_s", result.intervals[i].done_s)
            .set("done_uncertainty_s", result.intervals[i].done_uncertainty_s);
        set_summary(row, result.intervals[i].summary, device_.gives_force());
        row.update(database_, {"trial_id", "interval"});
    }
}

void SqliteRecorder::event(const protocols::Event& event) {
    with_room([&] {
        Transaction all(database_);
        if (event.kind == protocols::EventKind::mark) {
            add_mark(database_, session_, event.trial.value(), {event.text});
        } else {
            add_event(database_, session_, event);
        }
        all.commit();
    });
}

void SqliteRecorder::finish_session() {
    with_room([this] {
        Transaction all(database_);
        database_.run(
            "UPDATE session SET finished = 1, finished_utc = ?2 WHERE session_id = ?1 AND finished "
            "= 0",
            session_, database_.utc_now());
        // Power may fail once the end is on the disk and before anybody knows: it ended then, and
        // has its link.
        if (database_.changes() > 0) {
            chain_session(database_, session_);
        }
        all.commit();
    });
    with_room([this] { database_.checkpoint(); });
}

TraceWriter::TraceWriter(Database& database,
                         std::optional<engine::PantographSpec> machine,
                         std::int64_t period_ns)
    : database_(database), machine_(std::move(machine)), period_ns_(period_ns) {
    ticks_.reserve(2 * kChunkTicks);
    parts_.reserve(2 * kChunkTicks);
}

TraceWriter::~TraceWriter() = default;

void TraceWriter::begin(std::int64_t trial,
                        std::int64_t interval,
                        std::unique_ptr<engine::FeltScene> scene) {
    trial_ = trial;
    interval_ = interval;
    scene_ = std::move(scene);
    retrace_ = std::make_unique<Retrace>(machine_, scene_.get());
    ticks_.clear();
    parts_.clear();
    unsaved_ = 0;
    row_there_ = false;
}

void TraceWriter::add(std::span<const engine::TickRecord> ticks) {
    ticks_.insert(ticks_.end(), ticks.begin(), ticks.end());
    unsaved_ += ticks.size();
}

void TraceWriter::write() {
    if (unsaved_ == 0) {
        return;
    }
    const std::size_t known = parts_.size();
    parts_.resize(ticks_.size(), kAllParts);
    retrace_->parts(std::span(ticks_).subspan(known), std::span(parts_).subspan(known));
    // Ticks that go back, were there any, must not replace what stands.
    for (std::size_t first = 0; first < ticks_.size(); first += kChunkTicks) {
        const std::size_t n = std::min(kChunkTicks, ticks_.size() - first);
        const auto ticks = std::span(ticks_).subspan(first, n);
        std::uint8_t parts = 0;
        for (const std::uint8_t of_tick : std::span(parts_).subspan(first, n)) {
            parts = static_cast<std::uint8_t>(parts | of_tick);
        }
        const std::int64_t first_tick = ticks.front().tick;
        const EncodedChunk chunk = encode_chunk(ticks, first_tick, period_ns_, parts);
        Row row("trace_chunk");
        row.set("trial_id", trial_)
            .set("interval", interval_)
            .set("first_tick", first_tick)
            .set("ticks", n)
            .set("codec", kTraceCodec)
            .set("period_ns", period_ns_)
            .set("holds", parts_text(parts))
            .set("crc32", chunk.crc32)
            .set("derived", std::bit_cast<std::int64_t>(derived_hash(ticks)))
            .set("data", chunk.data);
        if (first == 0 && row_there_) {
            row.update(database_, {"trial_id", "interval", "first_tick"});
        } else {
            row.insert(database_);
        }
    }
}

void TraceWriter::saved() {
    const auto full = static_cast<std::ptrdiff_t>(ticks_.size() / kChunkTicks * kChunkTicks);
    ticks_.erase(ticks_.begin(), ticks_.begin() + full);
    parts_.erase(parts_.begin(), parts_.begin() + full);
    unsaved_ = 0;
    row_there_ = !ticks_.empty();
}

}  // namespace palpate::data
