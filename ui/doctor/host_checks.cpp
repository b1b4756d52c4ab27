#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "engine/base/clock.hpp"
#include "engine/base/descriptor.hpp"
#include "engine/base/files.hpp"
#include "engine/base/side_by_side.hpp"
#include "engine/base/text.hpp"
#include "data/store/database.hpp"
#include "ui/doctor/checks.hpp"

namespace palpate::ui {
namespace {

/// A file of its own in a folder, gone at the end.
class Scratch {
public:
    explicit Scratch(const std::filesystem::path& folder)
        : name_((folder / ".palpate-doctor-XXXXXX").string()), file_(mkstemp(name_.data())) {
        if (file_.get() < 0) {
            throw std::runtime_error(std::strerror(errno));
        }
        unlink(name_.c_str());
    }

    /// Appends a block as a trial's commit does and waits until it is on the disk; ms.
    double append_and_sync() {
        const std::array<char, 16384> block{};
        const std::int64_t before = monotonic_ns();
        if (write(file_.get(), block.data(), block.size()) != std::ssize(block) ||
            fsync(file_.get()) != 0) {
            throw std::runtime_error(std::strerror(errno));
        }
        return static_cast<double>(monotonic_ns() - before) * 1e-6;
    }

private:
    std::string name_;
    Descriptor file_;
};

/// @return the share of the time since `before` that the host of a virtual machine took
double add_stolen(Check& check, const std::optional<ProcessorTime>& before) {
    const auto after = processor_time();
    if (!before || !after || !(after->all > before->all)) {
        return 0.0;
    }
    const double stolen = (after->stolen - before->stolen) / (after->all - before->all);
    if (after->stolen > 0.0) {
        check.detail += fmt::format(", {:.2f} % of the time taken by the virtual machine's host",
                                    100.0 * stolen);
    }
    check.numbers.emplace_back("steal_share", stolen);
    return stolen;
}

double free_gib(const std::filesystem::path& folder) {
    constexpr double kGiB = 1024.0 * 1024.0 * 1024.0;
    struct statvfs system {};
    if (statvfs(folder.c_str(), &system) != 0) {
        throw std::runtime_error(std::strerror(errno));
    }
    return static_cast<double>(system.f_bavail) * static_cast<double>(system.f_frsize) / kGiB;
}

void judge_disk(Check& check, double room_gib, double sync_ms) {
    if (room_gib < 1.0) {
        check.warns("a session needs some 100 MiB: make room, or give --db on another disk");
    } else if (sync_ms > 50.0) {
        check.warns(
            "this disk is slow (a network folder or a USB stick?): keep the database "
            "on an inner disk and copy it afterwards");
    }
}

}  // namespace

std::optional<ProcessorTime> processor_time() {
    std::istringstream line(first_line("/proc/stat"));
    std::string word;
    line >> word;
    ProcessorTime time;
    double value = 0.0;
    for (int i = 0; i < 8 && line >> value;
         ++i) {  // user nice system idle iowait irq softirq steal
        time.all += value;
        time.stolen = i == 7 ? value : 0.0;
    }
    return word == "cpu" && time.all > 0.0 ? std::optional(time) : std::nullopt;
}

Check check_kernel() {
    utsname system{};
    uname(&system);
    const bool realtime = first_line("/sys/kernel/realtime") == "1" ||
                          std::string(system.version).find("PREEMPT_RT") != std::string::npos;
    // Not a warning: an ordinary kernel is enough for 1 kHz on a quiet machine.
    return {.name = "kernel",
            .detail = fmt::format("{} {}, {}", system.sysname, system.release,
                                  realtime ? "PREEMPT_RT" : "not PREEMPT_RT"),
            .numbers = {{"preempt_rt", realtime ? 1.0 : 0.0}}};
}

Check check_host(const std::optional<ProcessorTime>& before) {
    const std::size_t count = usable_processors();
    const std::string governor =
        first_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor");
    Check check{.name = "host",
                .detail = fmt::format(
                    "{}, {}", counted(count, "processor"),
                    governor.empty() ? "frequency not ours to choose" : "governor " + governor),
                .numbers = {{"processors", count}}};
    const auto advise = [&](const std::string& remedy) {
        check.status = CheckStatus::warn;
        check.remedy += (check.remedy.empty() ? "" : "; ") + remedy;
    };
    if (const auto stolen = add_stolen(check, before); stolen > 0.002) {
        advise("this is a virtual machine on a busy host: run sessions on a machine of its own");
    }
    if (count < 2) {
        advise("the screen and the force loop share one processor: use a machine with two or more");
    }
    if (!governor.empty() && governor != "performance") {
        advise("as root, for steadier timing: cpupower frequency-set -g performance");
    }
    return check;
}

Check check_disk(const std::string& database) {
    constexpr int kSyncs = 15;
    const auto parent =
        std::filesystem::weakly_canonical(std::filesystem::absolute(database)).parent_path();
    Check check{.name = "disk", .detail = parent.string()};
    try {
        if (std::filesystem::exists(database)) {
            const data::Database there(database, data::Access::inspect);
        }
        const double room = free_gib(parent);
        Scratch scratch(parent);
        std::array<double, kSyncs> times{};
        for (double& time : times) {
            time = scratch.append_and_sync();
        }
        std::sort(times.begin(), times.end());
        const double median = times[kSyncs / 2];
        check.detail += fmt::format(": {:.1f} GiB free, {:.1f} ms to sync (worst of {}: {:.1f} ms)",
                                    room, median, kSyncs, times.back());
        check.numbers = {
            {"free_gib", room}, {"sync_median_ms", median}, {"sync_worst_ms", times.back()}};
        judge_disk(check, room, median);
    } catch (const std::exception& e) {
        check.detail += fmt::format(": cannot write there: {}", e.what());
        check.fails("give --db FILE in a folder that is there and yours to write");
    }
    return check;
}

}  // namespace palpate::ui
