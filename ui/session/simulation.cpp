#include "ui/session/simulation.hpp"

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <system_error>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "engine/base/files.hpp"
#include "engine/base/refuse.hpp"
#include "engine/base/sha256.hpp"
#include "engine/base/text.hpp"
#include "protocols/file/observer_file.hpp"
#include "data/store/disk_space.hpp"
#include "data/store/secret.hpp"
#include "data/store/session_lock.hpp"
#include "data/store/session_store.hpp"
#include "data/sync/session_version.hpp"
#include "ui/rig/interrupt.hpp"
#include "ui/session/provenance.hpp"

namespace palpate::ui {
namespace {

namespace fs = std::filesystem;

/// Sessions that are done before their turn, for each thread: some 10 MB each with ticks.
constexpr std::size_t kAhead = 4;

std::vector<std::size_t> indices_of(const SimulationSpec& spec) {
    std::vector<std::size_t> indices;
    for (std::size_t i = spec.shard.number; i < spec.participants; i += spec.shard.of) {
        indices.push_back(i);
    }
    return indices;
}

/// The codes of a file's participants. @throws std::invalid_argument if it holds anything but these
/// simulated people
std::set<std::string> codes_in(data::Database& database, const SimulationSpec& spec) {
    const auto refuse = [&](bool other, const std::string& what) {
        refuse_if(other,
                  "{}: it holds {}: nothing is simulated into it. Give another --db, or move the "
                  "file away",
                  database.file(), what);
    };
    const SimulatedStudy& people = spec.people;
    const std::string observer = people.observer ? observer_text(*people.observer) : std::string();
    data::Statement row = database.prepare(
        "SELECT participant_code, session_kind, protocol_sha256, seed, secret, session_number, "
        "(SELECT value FROM session_provenance AS p WHERE p.session_id = session.session_id AND "
        "key = 'build id'), coalesce((SELECT value FROM session_provenance AS p WHERE p.session_id "
        "= session.session_id AND key = ?1), ''), coalesce((SELECT value FROM session_provenance "
        "AS p WHERE p.session_id = session.session_id AND key = ?2), '') FROM session JOIN study "
        "USING (study_id) JOIN participant USING (participant_id) WHERE finished = 1",
        data::kObserverKey, data::kTracesKey);
    std::set<std::string> codes;
    while (row.step()) {
        const std::string code = row.text(0);
        refuse(row.text(1) != "simulated", fmt::format("a {} session of {}", row.text(1), code));
        const auto same = [&](int column, const std::string& wanted, std::string_view what) {
            refuse(row.text(column) != wanted, fmt::format("{} with another {}", code, what));
        };
        same(2, people.study.hash, "protocol");
        same(3, std::to_string(people.seed), fmt::format("seed ({})", row.text(3)));
        same(4, people.secret, "secret");
        same(5, "1", "number of sessions");
        same(6, build_id(), "build of palpate");
        same(7, observer, "observer");
        refuse((row.text(8) == data::kNoTraces) == people.traces,
               fmt::format("{} {} ticks", code, people.traces ? "without" : "with"));
        codes.insert(code);
    }
    data::Statement all = database.first("SELECT count(*) FROM session");
    refuse(all.integer(0) != static_cast<std::int64_t>(codes.size()),
           "a session that is not finished");
    return codes;
}

/// Sessions that go into a file one by one, in the order of their codes, by whoever has the next
/// one.
class InOrder {
public:
    InOrder(const SimulationSpec& spec, data::Database& out, std::size_t first, std::size_t threads)
        : spec_(spec),
          out_(out),
          layout_(data::catalogue_layout()),
          next_(first),
          max_(kAhead * threads) {}

    /// Before work on the session begins: waits until few others wait for their turn. @return
    /// false: it is over
    bool may_begin(std::size_t place) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return over_ || place < next_ + max_; });
        return !over_;
    }
    /// @param session  none: it was interrupted
    void give(std::size_t place, std::unique_ptr<data::Database> session) {
        const std::lock_guard lock(mutex_);
        if (!session) {
            over_ = true;
        } else {
            done_[place] = std::move(session);
        }
        for (auto first = done_.begin(); !over_ && first != done_.end() && first->first == next_;
             first = done_.erase(first), ++next_) {
            append(*first->second);
        }
        changed_.notify_all();
    }
    void fail(std::exception_ptr error) {
        const std::lock_guard lock(mutex_);
        error_ = error_ ? error_ : std::move(error);
        over_ = true;
        changed_.notify_all();
    }
    /// After all threads. @throws what one of them threw
    [[nodiscard]] bool over() const {
        if (error_) {
            std::rethrow_exception(error_);
        }
        return over_;
    }

private:
    void append(data::Database& session) {
        data::Transaction all(out_);
        out_.execute("PRAGMA defer_foreign_keys = ON");
        data::append_session(session, out_, layout_);
        all.commit();
        if (spec_.progress) {
            spec_.progress(session.file(), next_ + 1);
        }
    }

    const SimulationSpec& spec_;
    data::Database& out_;
    data::Layout layout_;
    std::mutex mutex_;
    std::condition_variable changed_;
    std::map<std::size_t, std::unique_ptr<data::Database>> done_;
    std::size_t next_;
    std::size_t max_;
    std::exception_ptr error_;
    bool over_ = false;
};

/// @return false: stopped by a signal
bool run_all(const SimulationSpec& spec, data::Database& out, std::size_t first) {
    const std::vector<std::size_t> indices = indices_of(spec);
    const auto rows = provenance(spec.people.study.protocol);
    const std::size_t threads =
        std::clamp<std::size_t>(indices.size() - first, 1, std::max<std::size_t>(spec.threads, 1));
    InOrder sessions(spec, out, first, threads);
    std::atomic<std::size_t> next{first};
    const auto work = [&] {
        try {
            for (std::size_t at = next++; at < indices.size() && sessions.may_begin(at);
                 at = next++) {
                sessions.give(at, interrupted()
                                      ? nullptr
                                      : SimulatedSession(spec.people, indices[at]).run(rows));
            }
        } catch (...) {
            sessions.fail(std::current_exception());
        }
    };
    {
        std::vector<std::jthread> others;
        for (std::size_t i = 1; i < threads; ++i) {
            others.emplace_back(work);
        }
        work();
    }
    return !sessions.over();
}

void remove_database(const fs::path& file) {
    std::error_code unknown;
    for (const char* part : {"", "-wal", "-shm", "-journal"}) {
        fs::remove(file.string() + part, unknown);
    }
}

[[noreturn]] void cannot_keep(const fs::path& file, const std::error_code& why) {
    throw std::runtime_error(fmt::format(
        "{}: the file could not be put there: {}; the same command goes on with what was simulated",
        file.string(), why.message()));
}

/// The file under its own name, from one moment to the next. @param made  whole, in the same folder
void put_in_place(const fs::path& made, const fs::path& file) {
    std::error_code why;
    if (!sync_to_disk(made)) {
        cannot_keep(file, {errno, std::generic_category()});
    }
    fs::rename(made, file, why);
    if (why) {
        cannot_keep(file, why);
    }
    static_cast<void>(sync_to_disk(folder_of(file)));
}

/// A new file of its owner's alone beside its place, by a name that nobody can guess: whoever may
/// write there cannot lay a link. It goes with this unless it was put in place.
class NewFile {
public:
    explicit NewFile(const fs::path& place) : name_(made(place)), lock_(name_) {}
    ~NewFile() {
        std::error_code gone;
        fs::remove(name_, gone);
    }
    [[nodiscard]] const fs::path& name() const noexcept { return name_; }

private:
    static fs::path made(const fs::path& place) {
        remove_leftovers(folder_of(place));
        std::string name = place.string() + std::string(kPartName) + "XXXXXX";
        const int fd = ::mkostemp(name.data(), O_CLOEXEC);
        if (fd < 0) {
            cannot_keep(place, {errno, std::generic_category()});
        }
        ::close(fd);
        return name;
    }

    fs::path name_;
    PartLock lock_;
};

/// What the rows say in a file of its own, whose bytes depend on nothing else.
void write_anew(data::Database& from, const fs::path& to) {
    const NewFile made(to);
    from.run("VACUUM INTO ?1", data::plain_name(made.name().string()));
    put_in_place(made.name(), to);
}

/// @pre nobody has it open, and its log is empty
void copy_over(const fs::path& from, const fs::path& to) {
    const NewFile made(to);
    std::error_code why;
    fs::copy_file(from, made.name(), fs::copy_options::overwrite_existing, why);
    if (why) {
        cannot_keep(to, why);
    }
    put_in_place(made.name(), to);
}

/// In a folder that many studies may share nobody else's is called the same.
fs::path growing_file(const SimulationSpec& spec, const fs::path& kept) {
    if (spec.scratch.empty()) {
        return kept;
    }
    const std::string whose = sha256_hex(fs::absolute(spec.file).string()).substr(0, 12);
    return spec.scratch / fmt::format("{}.{}.partial", spec.file.filename().string(), whose);
}

/// Whether all is in it already. @throws as codes_in()
bool whole(const SimulationSpec& spec, const fs::path& file) {
    data::Database there(file.string(), data::Access::read);
    const std::set<std::string> codes = codes_in(there, spec);
    const std::vector<std::size_t> indices = indices_of(spec);
    const auto is_there = [&](std::size_t i) {
        return codes.contains(simulated_code(i));
    };
    refuse_if(codes.size() != indices.size() || !std::ranges::all_of(indices, is_there),
              "{}: it holds {} other than the {} asked for: give the same --participants and "
              "--shard, or another --db",
              file.string(), counted(codes.size(), "participant"), indices.size());
    return true;
}

/// How many sessions a growing file has: those of the first participants.
std::size_t grown(const SimulationSpec& spec, data::Database& partial) {
    const std::set<std::string> codes = codes_in(partial, spec);
    const std::vector<std::size_t> indices = indices_of(spec);
    for (std::size_t i = 0; i < codes.size(); ++i) {
        refuse_if(i >= indices.size() || !codes.contains(simulated_code(indices[i])),
                  "{}: it holds other participants than those asked for: give the same "
                  "--participants and --shard, or move it away",
                  partial.file());
    }
    return codes.size();
}

}  // namespace

Shard parse_shard(const std::string& text) {
    constexpr std::size_t kMax = 100'000;
    const std::size_t slash = std::min(text.find('/'), text.size());
    const auto number = parsed<std::size_t>(std::string_view(text).substr(0, slash));
    const auto of =
        parsed<std::size_t>(std::string_view(text).substr(std::min(slash + 1, text.size())));
    refuse_if(!number || !of || *number >= *of || *of > kMax,
              "--shard {}: give K/N, a number from 0 to N - 1 of at most {}, as 0/8", text, kMax);
    return {.number = *number, .of = *of};
}

std::string shard_name(const Shard& shard) {
    return fmt::format("shard-{:03}-of-{:03}.sqlite", shard.number, shard.of);
}

std::size_t participants_of(const Shard& shard, std::size_t participants) noexcept {
    return participants > shard.number ? (participants - shard.number - 1) / shard.of + 1 : 0;
}

SimulationEnd simulate(const SimulationSpec& spec) {
    std::error_code unknown;
    if (fs::exists(spec.file, unknown) && whole(spec, spec.file)) {
        return SimulationEnd::was_there;
    }
    data::require_not_elsewhere(spec.file.string());
    const fs::path kept = spec.file.string() + ".partial";
    const fs::path growing = growing_file(spec, kept);
    if (growing != kept && fs::exists(kept, unknown) && !fs::exists(growing, unknown)) {
        data::Database(kept.string(), data::Access::write).checkpoint();
        copy_over(kept, growing);
    }
    bool all = false;
    {
        data::Database out(growing.string(), data::Access::write);
        const data::SessionLock lock(out, 0);
        const std::size_t first = grown(spec, out);
        set_secret(out, spec.people.secret);
        all = run_all(spec, out, first);
        out.checkpoint();
        if (all) {
            write_anew(out, spec.file);
        }
    }
    if (!all && growing != kept) {
        copy_over(growing, kept);
    }
    if (all || growing != kept) {
        remove_database(growing);
    }
    if (all && growing != kept) {
        remove_database(kept);
    }
    return all ? SimulationEnd::made : SimulationEnd::stopped;
}

}  // namespace palpate::ui
