#include <iostream>

#include "tests/bench/commands.hpp"
#include "tests/bench/data/own_store.hpp"
#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

namespace fs = std::filesystem;

/// A folder for the stores, gone afterwards.
class Folder {
public:
    Folder() : path_(fs::temp_directory_path() / fmt::format("palpate-bench-{}", ::getpid())) {
        fs::create_directories(path_);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    [[nodiscard]] std::string name() const { return path_.string(); }

private:
    fs::path path_;
};

/// @param mean_force  of the first trial, N: all stores must agree; 0: the first store says it
std::vector<Figure> measure(TraceStore& store,
                            const std::vector<std::vector<engine::TickRecord>>& made,
                            std::int64_t trials,
                            const Stopwatch& watch,
                            double& mean_force) {
    std::vector<double> ingest;
    std::size_t samples = 0;
    for (std::int64_t trial = 1; trial <= trials; ++trial) {
        const auto& ticks = made[static_cast<std::size_t>(trial - 1) % made.size()];
        const double writing = watch.seconds([&] { store.write(trial, ticks); });
        ingest.push_back(1e-6 * static_cast<double>(ticks.size()) / writing);
        samples += ticks.size();
    }
    const double last = watch.seconds([&] { store.finish(); });
    const double mean = store.mean_normal_force(1);
    mean_force = mean_force == 0.0 ? mean : mean_force;
    if (!(std::fabs(mean - mean_force) <= 1e-9 * std::fabs(mean_force))) {
        throw std::runtime_error(store.name() + " gives another mean force than the first store");
    }
    std::vector<double> ask;
    std::vector<double> scan;
    std::vector<double> prove;
    for (std::int64_t trial = 1; trial <= std::min<std::int64_t>(trials, 15); ++trial) {
        ask.push_back(1e3 *
                      watch.seconds([&] { static_cast<void>(store.mean_normal_force(trial)); }));
    }
    for (int i = 0; i < 6; ++i) {
        scan.push_back(watch.seconds([&] { static_cast<void>(store.mean_command_x()); }));
        std::size_t proved = 0;
        const double proving = watch.seconds([&] { proved = store.verify(); });
        prove.push_back(1e-6 * static_cast<double>(proved) / proving);
    }
    const double bytes = static_cast<double>(store.bytes()) / static_cast<double>(samples);
    std::vector<Figure> figures{{"size", "bytes a sample", median({bytes})},
                                {"ingest", "million samples/s", median(ingest)},
                                {"end of all writing", "s", median({last})},
                                {"avg(rendered_normal_n) of a trial", "ms", median(ask)},
                                {"avg(commanded_x_n) of everything", "s", median(scan)}};
    if (prove.front() > 0.0) {
        figures.push_back({"verify", "million samples/s", median(prove)});
    }
    return figures;
}

std::vector<std::unique_ptr<TraceStore>> stores(const std::string& folder, const MadeStudy& study) {
    std::vector<std::unique_ptr<TraceStore>> all;
    all.push_back(own_store(folder, study));
    all.push_back(row_store(folder));
    all.push_back(csv_store(folder));
    if (auto hdf5 = hdf5_store(folder)) {
        all.push_back(std::move(hdf5));
    }
    return all;
}

}  // namespace

int data_command(Words words) {
    static_cast<void>(words.flag("--peers"));  // where they are built in they are measured
    const int trials = static_cast<int>(words.number("--trials", 60, 1, 1e6));
    const double seconds = words.number("--seconds", 30.0, 0.1, 3600.0);
    const Stopwatch watch{static_cast<int>(words.number("--cores", 1, 1, 2))};
    const std::string csv_name = words.value("--csv");
    words.finish();
    pin_to(watch.cores);
    Output csv(csv_name, "machine,cores,trials,seconds,store,figure,unit,median,low,high\n");
    std::cout << fmt::format(
        "{}; {} trials of {} s at 1 kHz; {}\n", machine(), trials, seconds,
        watch.cores == 1 ? "on one core, seconds of the processor" : "seconds of the wall clock");
    const auto report = [&](const std::string& store, const std::vector<Figure>& figures) {
        for (const Figure& one : figures) {
            std::cout << fmt::format("{:<24} {:<34} {:>9.4g} [{:.4g}, {:.4g}] {}\n", store,
                                     one.name, one.value.value, one.value.low, one.value.high,
                                     one.unit)
                      << std::flush;
            csv << fmt::format("\"{}\",{},{},{},\"{}\",\"{}\",{},{:.5g},{:.5g},{:.5g}\n", machine(),
                               watch.cores, trials, seconds, store, one.name, one.unit,
                               one.value.value, one.value.low, one.value.high);
        }
    };
    const MadeStudy study = made_study();
    std::vector<std::vector<engine::TickRecord>> made;
    for (std::size_t i = 0; i < 10; ++i) {
        made.push_back(made_trial(study, 10 + i, seconds));
    }
    report("in memory", measure_own(study, made, watch));
    const Folder folder;
    double mean_force = 0.0;
    for (const auto& store : stores(folder.name(), study)) {
        report(store->name(), measure(*store, made, trials, watch, mean_force));
    }
    csv.finish();
    return 0;
}

}  // namespace palpate::bench
