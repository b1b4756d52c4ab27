#include "ui/live/live_segment.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>
#include <span>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/refuse.hpp"
#include "ui/rig/json_line.hpp"

namespace palpate::ui {
namespace {

using Word = std::atomic<std::uint64_t>;
static_assert(Word::is_always_lock_free && sizeof(Word) == 8, "it lies in shared memory");

constexpr std::uint64_t kMagic = 0x3176696c706c6170;  // "palplive", version 1
constexpr int kTries = 1000;

template <std::size_t Bytes>
using Words = std::array<Word, Bytes / sizeof(Word)>;

void put(std::span<Word> words, const void* bytes, std::size_t size) noexcept {
    for (std::size_t at = 0; at < size; at += sizeof(Word)) {
        std::uint64_t word = 0;
        std::memcpy(&word, static_cast<const char*>(bytes) + at, std::min(sizeof word, size - at));
        words[at / sizeof word].store(word, std::memory_order_relaxed);
    }
}

void take(std::span<const Word> words, void* bytes, std::size_t size) noexcept {
    for (std::size_t at = 0; at < size; at += sizeof(Word)) {
        const std::uint64_t word = words[at / sizeof(Word)].load(std::memory_order_relaxed);
        std::memcpy(static_cast<char*>(bytes) + at, &word, std::min(sizeof word, size - at));
    }
}

/// Runs `write` between two steps of the sequence.
template <class Write>
void with_sequence(Word& sequence, const Write& write) {
    const std::uint64_t before = sequence.load(std::memory_order_relaxed);
    sequence.store(before + 1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_release);
    write();
    sequence.store(before + 2, std::memory_order_release);
}

/// Runs `read` until nothing was written meanwhile. @return false: something always was
template <class Read>
bool at_rest(const Word& sequence, const Read& read) {
    for (int tries = 0; tries < kTries; ++tries) {
        const std::uint64_t before = sequence.load(std::memory_order_acquire);
        if ((before & 1U) == 0) {
            read();
            std::atomic_thread_fence(std::memory_order_acquire);
            if (sequence.load(std::memory_order_relaxed) == before) {
                return true;
            }
        }
    }
    return false;
}

}  // namespace

/// Odd sequence: its words are being written.
struct LiveMemory {
    Word magic;
    Word state_sequence;
    Word phase_ns;
    Word length;
    Words<LiveWriter::kStateRoom> state;
    Word tick_sequence;
    Word ticks;  ///< shown so far
    std::array<Words<sizeof(LiveTick)>, LiveWriter::kRing> ring;
    Word answered_ns;
};

void Unmap::operator()(const LiveMemory* memory) const noexcept {
    munmap(const_cast<LiveMemory*>(memory), sizeof(LiveMemory));  // NOLINT: as mmap gave it
}

LiveWriter::LiveWriter() noexcept {
    Descriptor file(memfd_create("palpate-live", MFD_CLOEXEC | MFD_ALLOW_SEALING));
    if (file.get() < 0 || fchmod(file.get(), S_IRUSR | S_IWUSR) != 0 ||
        posix_fallocate(file.get(), 0, sizeof(LiveMemory)) != 0) {
        return;
    }
    void* at = mmap(nullptr, sizeof(LiveMemory), PROT_READ | PROT_WRITE, MAP_SHARED, file.get(), 0);
    if (at == MAP_FAILED) {
        return;
    }
    std::unique_ptr<LiveMemory, Unmap> memory(new (at) LiveMemory{});
    // Nobody makes it shorter under a writer, and who gets it later can map it for reading alone.
    if (fcntl(file.get(), F_ADD_SEALS,
              F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_FUTURE_WRITE | F_SEAL_SEAL) == 0) {
        memory->magic = kMagic;
        memory_ = std::move(memory);
        file_ = std::move(file);
    }
}

void LiveWriter::show(std::string_view state, std::int64_t phase_ns) noexcept {
    if (memory_ == nullptr || state.size() > kStateRoom) {
        return;
    }
    with_sequence(memory_->state_sequence, [&] {
        memory_->phase_ns.store(static_cast<std::uint64_t>(phase_ns), std::memory_order_relaxed);
        memory_->length.store(state.size(), std::memory_order_relaxed);
        put(memory_->state, state.data(), state.size());
    });
}

void LiveWriter::show(const LiveTick& tick) noexcept {
    if (memory_ == nullptr) {
        return;
    }
    with_sequence(memory_->tick_sequence, [&] {
        const std::uint64_t count = memory_->ticks.load(std::memory_order_relaxed);
        put(memory_->ring[count % kRing], &tick, sizeof tick);
        memory_->ticks.store(count + 1, std::memory_order_relaxed);
    });
}

void LiveWriter::answers() noexcept {
    if (memory_ != nullptr) {
        memory_->answered_ns.store(static_cast<std::uint64_t>(monotonic_ns()),
                                   std::memory_order_relaxed);
    }
}

LiveReader::LiveReader(int descriptor) {
    struct stat file {};
    void* at = fstat(descriptor, &file) == 0 && file.st_size == sizeof(LiveMemory)
                 ? mmap(nullptr, sizeof(LiveMemory), PROT_READ, MAP_SHARED, descriptor, 0)
                 : MAP_FAILED;
    memory_.reset(at != MAP_FAILED ? static_cast<const LiveMemory*>(at) : nullptr);
    refuse_if<std::runtime_error>(
        memory_ == nullptr || memory_->magic != kMagic,
        "the session shows nothing that this palpate reads: use the one that runs it");
}

std::uint64_t LiveReader::version() const noexcept {
    return memory_->state_sequence.load(std::memory_order_acquire);
}

std::int64_t LiveReader::answered_ns() const noexcept {
    return static_cast<std::int64_t>(memory_->answered_ns.load(std::memory_order_relaxed));
}

std::optional<LiveState> LiveReader::state() const {
    LiveState state;
    const auto whole = at_rest(memory_->state_sequence, [&] {
        state.phase_ns =
            static_cast<std::int64_t>(memory_->phase_ns.load(std::memory_order_relaxed));
        state.json.resize(std::min<std::size_t>(memory_->length.load(std::memory_order_relaxed),
                                                LiveWriter::kStateRoom));
        take(memory_->state, state.json.data(), state.json.size());
    });
    return whole ? std::optional(std::move(state)) : std::nullopt;
}

std::pair<std::vector<LiveTick>, std::uint64_t> LiveReader::ticks_after(std::uint64_t seen) const {
    std::vector<LiveTick> ticks;
    std::uint64_t count = seen;
    const auto whole = at_rest(memory_->tick_sequence, [&] {
        ticks.clear();
        count = memory_->ticks.load(std::memory_order_relaxed);
        const std::uint64_t kept = std::min<std::uint64_t>(count, LiveWriter::kRing);
        for (std::uint64_t i = std::max(std::min(seen, count), count - kept); i < count; ++i) {
            take(memory_->ring[i % LiveWriter::kRing], &ticks.emplace_back(), sizeof(LiveTick));
        }
    });
    return whole ? std::pair{std::move(ticks), count} : std::pair{std::vector<LiveTick>(), seen};
}

std::vector<RunningSession> running_sessions(const std::optional<std::string>& of) {
    const bool is_file = of && identity_of(*of) && !of->empty();
    std::vector<RunningSession> all;
    for (const std::string& name : session_names(is_file ? of : std::nullopt)) {
        const Received answer = ask_session(name, R"({"do":"state"})");
        const data::Json said = object_in(answer.line);
        if (!said.contains("state") || !said["state"].is_object()) {
            continue;
        }
        std::string uuid = said["state"].value("session", "");
        if (of && !is_file && uuid != *of) {
            continue;
        }
        Descriptor process(
            static_cast<int>(syscall(SYS_pidfd_open, said.value("pid", pid_t{-1}), 0)));
        if (process.get() < 0) {
            continue;
        }
        try {
            all.push_back({.name = name,
                           .file = said.value("file", ""),
                           .uuid = std::move(uuid),
                           .process = std::move(process),
                           .reader = std::make_unique<LiveReader>(answer.file.get())});
        } catch (const std::runtime_error&) {  // of another version
        }
    }
    return all;
}

}  // namespace palpate::ui
