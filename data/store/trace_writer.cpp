#include "data/store/trace_writer.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "data/trace/chunk.hpp"
#include "data/trace/derived_hash.hpp"

namespace palpate::data {

TraceWriter::TraceWriter(Database& database,
                         std::optional<engine::PantographSpec> machine,
                         std::int64_t period_ns)
    : database_(database), machine_(std::move(machine)), period_ns_(period_ns) {
    ticks_.reserve(2 * kChunkTicks);
    parts_.reserve(2 * kChunkTicks);
}

void TraceWriter::begin(std::int64_t trial,
                        std::int64_t interval,
                        std::unique_ptr<engine::Scene> scene) {
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
    for (const engine::TickRecord& tick : ticks) {
        parts_.push_back(retrace_->parts(tick));
    }
    unsaved_ += ticks.size();
}

bool TraceWriter::is_full() const noexcept {
    return ticks_.size() >= kChunkTicks;
}

void TraceWriter::write() {
    if (unsaved_ == 0) {
        return;
    }
    // Ticks that go back, were there any, must not replace what stands.
    Statement insert = database_.prepare(
        "INSERT INTO trace_chunk VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10)");
    Statement replace = database_.prepare(
        "UPDATE trace_chunk SET ticks = ?4, codec = ?5, period_ns = ?6, holds = ?7, crc32 = ?8, "
        "derived = ?9, data = ?10 WHERE trial_id = ?1 AND interval = ?2 AND first_tick = ?3");
    for (std::size_t first = 0; first < ticks_.size(); first += kChunkTicks) {
        const std::size_t n = std::min(kChunkTicks, ticks_.size() - first);
        const auto ticks = std::span(ticks_).subspan(first, n);
        std::uint8_t parts = 0;
        for (const std::uint8_t of_tick : std::span(parts_).subspan(first, n)) {
            parts = static_cast<std::uint8_t>(parts | of_tick);
        }
        const std::int64_t first_tick = ticks.front().tick;
        const EncodedChunk chunk = encode_chunk(ticks, first_tick, period_ns_, parts);
        Statement& row = first == 0 && row_there_ ? replace : insert;
        row.bind(1, trial_)
            .bind(2, interval_)
            .bind(3, first_tick)
            .bind(4, static_cast<std::int64_t>(n))
            .bind(5, kTraceCodec)
            .bind(6, period_ns_)
            .bind(7, parts_text(parts))
            .bind(8, std::int64_t{chunk.crc32})
            .bind(9, std::bit_cast<std::int64_t>(derived_hash(ticks)))
            .bind(10, std::span<const std::byte>(chunk.data))
            .run();
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
