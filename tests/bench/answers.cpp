#include <iostream>

#include <linux/perf_event.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>

#include "tests/bench/other_build.hpp"
#include "tests/bench/timing.hpp"

/// The child's side of OtherBuild, and the kernel's counter.
namespace palpate::bench {
namespace {

constexpr std::size_t kCounted = 5000;  ///< ticks

/// Instructions of this thread outside the kernel, by the processor's own counter.
class Counter {
public:
    Counter() {
        perf_event_attr wanted{};
        wanted.size = sizeof wanted;
        wanted.type = PERF_TYPE_HARDWARE;
        wanted.config = PERF_COUNT_HW_INSTRUCTIONS;
        wanted.disabled = 1;
        wanted.exclude_kernel = 1;
        wanted.exclude_hv = 1;
        file_ = static_cast<int>(
            syscall(SYS_perf_event_open, &wanted, 0, -1, -1, PERF_FLAG_FD_CLOEXEC));
        error_ = file_ < 0 ? errno : 0;
    }
    Counter(const Counter&) = delete;
    Counter& operator=(const Counter&) = delete;
    ~Counter() { close(file_); }

    [[nodiscard]] int error() const { return error_; }
    void start() const {
        ioctl(file_, PERF_EVENT_IOC_RESET, 0);
        ioctl(file_, PERF_EVENT_IOC_ENABLE, 0);
    }
    [[nodiscard]] std::uint64_t stop() const {
        ioctl(file_, PERF_EVENT_IOC_DISABLE, 0);
        std::uint64_t count = 0;
        return read(file_, &count, sizeof count) == sizeof count ? count : 0;
    }

private:
    int file_ = -1;
    int error_ = 0;
};

/// Callgrind counts what happens in it, by its name.
template <int D>
[[gnu::noinline]] void palpate_bench_counted(Method<D>& method, std::span<const Vec<D>> hips) {
    method.run(hips);
    asm volatile("");
}

/// Callgrind writes what it has counted when this is left.
[[gnu::noinline]] void palpate_bench_done() {
    asm volatile("");
}

struct Answering {
    Stand stand;
    Counter counter{};
    Passes passes{};

    template <int D>
    std::string operator()(const std::string& what, Course<D>& course, const std::string& name) {
        const auto method =
            std::ranges::find(course.methods, name, [](const auto& one) { return one->name(); });
        if (method == course.methods.end()) {
            return "none";
        }
        const std::span<const Vec<D>> hips(course.hips);
        if (what.rfind("pass ", 0) == 0) {
            pass(passes, **method, hips, std::stoul(what.substr(5)), stand);
            return fmt::format("{}", fmt::join(passes.ns.back(), " "));
        }
        const auto few = hips.first(std::min(kCounted, hips.size()));
        (*method)->reset(few.front());
        counter.start();
        palpate_bench_counted(**method, few);
        const std::uint64_t count = counter.stop();
        palpate_bench_done();
        return fmt::format("{} {}", few.size(), count);
    }
};

}  // namespace

void answer_requests(const CoursePlan& plan) {
    const std::vector<CourseMaker> makers = courses(plan);
    Answering answering;
    std::optional<AnyCourse> course;
    std::array<std::string, 3> last;
    for (std::string line; std::getline(std::cin, line);) {
        std::istringstream words(line);
        std::string what;
        std::array<std::string, 3> place;  // object, path, method
        std::getline(words, what, '\t');
        for (std::string& word : place) {
            std::getline(words, word, '\t');
        }
        if (place[0] != last[0] || place[1] != last[1]) {
            const auto maker = std::ranges::find_if(makers, [&](const CourseMaker& one) {
                return one.object == place[0] && one.path == place[1];
            });
            course = maker == makers.end() ? std::nullopt : std::optional(maker->make());
        }
        if (place != last) {
            answering.passes = {};
            last = place;
        }
        std::cout << (course ? std::visit([&](auto& one) { return answering(what, one, place[2]); },
                                          *course)
                             : "none")
                  << std::endl;
    }
}

Counting counting() {
    const int error = Counter().error();
    if (error == 0) {
        return {Counting::By::kernel, "instructions by the kernel's counter"};
    }
    const std::string why = fmt::format("the kernel has no counter here: {}", std::strerror(error));
    if (std::system("valgrind --version >/dev/null 2>&1") == 0) {
        return {Counting::By::callgrind, "instructions by callgrind (" + why + ")"};
    }
    return {Counting::By::nobody, "instructions are not counted (" + why +
                                      "; with valgrind installed, callgrind would count)"};
}

}  // namespace palpate::bench
