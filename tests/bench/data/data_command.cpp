#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <unistd.h>

#include "tests/bench/commands.hpp"
#include "tests/bench/data/made_trials.hpp"
#include "tests/bench/data/own_store.hpp"
#include "tests/bench/data/trace_store.hpp"
#include "tests/bench/peers/peers.hpp"
#include "tests/bench/report.hpp"
#include "tests/bench/timing.hpp"

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

double seconds_of(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

struct Result {
    std::string store;
    double bytes_per_sample = 0.0;
    double ingest = 0.0;        ///< million samples/s
    double one_trial_ms = 0.0;  ///< mean normal force of a trial, median
    double scan_s = 0.0;        ///< mean commanded force over all trials
    double mean_force = 0.0;    ///< of the first trial, N: all stores must agree
};

Result measure(TraceStore& store,
               const std::vector<std::vector<engine::TickRecord>>& made,
               std::int64_t trials) {
    Result result{.store = store.name()};
    std::size_t samples = 0;
    const double writing = seconds_of([&] {
        for (std::int64_t trial = 1; trial <= trials; ++trial) {
            const auto& ticks = made[static_cast<std::size_t>(trial - 1) % made.size()];
            store.write(trial, ticks);
            samples += ticks.size();
        }
        store.finish();
    });
    result.ingest = 1e-6 * static_cast<double>(samples) / writing;
    result.bytes_per_sample = static_cast<double>(store.bytes()) / static_cast<double>(samples);
    result.mean_force = store.mean_normal_force(1);
    std::vector<double> times;
    for (std::int64_t trial = 1; trial <= std::min<std::int64_t>(trials, 15); ++trial) {
        times.push_back(1e3 *
                        seconds_of([&] { static_cast<void>(store.mean_normal_force(trial)); }));
    }
    result.one_trial_ms = percentile(times, 0.5);
    result.scan_s = seconds_of([&] { static_cast<void>(store.mean_command_x()); });
    return result;
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

int data_command(const std::vector<std::string>& arguments) {
    Words words(arguments);
    const bool peers = words.flag("--peers");
    const int trials = std::stoi(words.value("--trials", "200"));
    const double seconds = std::stod(words.value("--seconds", "30"));
    const std::string csv_name = words.value("--csv");
    words.finish("data takes --peers, --trials N, --seconds S and --csv FILE");
    need_peers_if(peers);
    std::ofstream csv = open_output(csv_name);
    const MadeStudy study = made_study();
    std::vector<std::vector<engine::TickRecord>> made;
    for (std::size_t i = 0; i < 10; ++i) {
        made.push_back(made_trial(study, 10 + i, seconds));
    }
    std::cout << machine() << '\n';
    std::printf("%d trials of %g s at 1 kHz\n", trials, seconds);
    const Own own = measure_own(study, made);
    std::printf(
        "encode %.2f, decode of one stored column %.1f, full replay %.2f, one trial after the "
        "other %.2f million samples/s\n",
        own.encode, own.decode, own.replay, own.replay_one);
    std::printf(
        "schema compared at open: %.3f ms of the processor, the first time in a program %.3f ms\n",
        own.schema_ms, own.schema_first_ms);
    std::printf("%-28s %8s %10s %14s %12s %18s\n", "store", "bytes/s.", "ingest M/s",
                "avg(rendered_normal_n) ms", "avg(commanded_x_n) s", "mean fn, trial 1");
    if (csv.is_open()) {
        csv << "machine,store,trials,seconds,bytes_per_sample,ingest_msps,avg_fn_trial_ms,"
               "avg_fx_scan_s,encode_msps,decode_msps,replay_msps,replay_one_msps\n";
    }
    const Folder folder;
    for (const auto& store : stores(folder.name(), study)) {
        const Result r = measure(*store, made, trials);
        std::printf("%-28s %8.2f %10.2f %14.2f %12.3f %18.12f\n", r.store.c_str(),
                    r.bytes_per_sample, r.ingest, r.one_trial_ms, r.scan_s, r.mean_force);
        std::fflush(stdout);
        if (csv.is_open()) {
            csv << fmt::format(
                "\"{}\",\"{}\",{},{},{:.3f},{:.4f},{:.3f},{:.4f},{:.3f},{:.2f},{:.3f},{:.3f}\n",
                machine(), r.store, trials, seconds, r.bytes_per_sample, r.ingest, r.one_trial_ms,
                r.scan_s, own.encode, own.decode, own.replay, own.replay_one);
        }
    }
    if (csv.is_open()) {
        close_output(csv, csv_name);
    }
    return 0;
}

}  // namespace palpate::bench
