#include "tests/bench/data/trace_store.hpp"
#include "tests/support/slurp.hpp"

namespace palpate::bench {
namespace {

using engine::TickRecord;

constexpr const char* kHead =
    "tick,time_ns,count_1,count_2,code_1,code_2,lateness_us,flags,mode,segment,u,hip_x_m,"
    "hip_y_m,cp_x_m,cp_y_m,go_x_m,go_y_m,fx_n,fy_n,command_x_n,command_y_n,fn_n,ft_n,mu\n";
constexpr int kX = 19;  // places in kHead
constexpr int kFn = 21;

class CsvStore : public TraceStore {
public:
    explicit CsvStore(std::string folder) : folder_(std::move(folder)) {}

    [[nodiscard]] std::string name() const override { return "CSV, a file a trial"; }

    void write(std::int64_t trial, std::span<const TickRecord> ticks) override {
        std::string text = kHead;
        auto out = std::back_inserter(text);
        for (const TickRecord& t : ticks) {
            fmt::format_to(
                out, "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                t.tick, t.time_ns, t.counts[0], t.counts[1], t.codes[0], t.codes[1], t.lateness_us,
                t.flags, static_cast<int>(t.mode), t.segment, t.u, t.hip.x, t.hip.y, t.cp.x, t.cp.y,
                t.go.x, t.go.y, t.force.x, t.force.y, t.command.x, t.command.y, t.normal_force,
                t.tangential_force, t.mu);
        }
        std::ofstream file(file_of(trial), std::ios::binary);
        if (!file.write(text.data(), static_cast<std::streamsize>(text.size())).flush()) {
            throw std::runtime_error("cannot write " + file_of(trial));
        }
        trials_ = trial;
    }
    void finish() override {}
    [[nodiscard]] std::uintmax_t bytes() const override {
        std::uintmax_t sum = 0;
        for (std::int64_t trial = 1; trial <= trials_; ++trial) {
            sum += std::filesystem::file_size(file_of(trial));
        }
        return sum;
    }
    [[nodiscard]] double mean_normal_force(std::int64_t trial) override {
        Sum sum;
        add(trial, kFn, sum);
        return sum.value / static_cast<double>(sum.n);
    }
    [[nodiscard]] double mean_command_x() override {
        Sum sum;
        for (std::int64_t trial = 1; trial <= trials_; ++trial) {
            add(trial, kX, sum);
        }
        return sum.value / static_cast<double>(sum.n);
    }

private:
    struct Sum {
        double value = 0.0;
        std::size_t n = 0;
    };
    [[nodiscard]] std::string file_of(std::int64_t trial) const {
        return fmt::format("{}/trial_{}.csv", folder_, trial);
    }
    void add(std::int64_t trial, int column, Sum& sum) const {
        const std::string text = tests::slurp(file_of(trial));
        const char* at = text.data() + text.find('\n') + 1;
        const char* end = text.data() + text.size();
        while (at < end) {
            for (int i = 0; i < column; ++i) {
                at = static_cast<const char*>(
                         std::memchr(at, ',', static_cast<std::size_t>(end - at))) +
                     1;
            }
            double value = 0.0;
            std::from_chars(at, end, value);
            sum.value += value;
            ++sum.n;
            at = static_cast<const char*>(
                     std::memchr(at, '\n', static_cast<std::size_t>(end - at))) +
                 1;
        }
    }

    std::string folder_;
    std::int64_t trials_ = 0;
};

}  // namespace

std::unique_ptr<TraceStore> csv_store(const std::string& folder) {
    return std::make_unique<CsvStore>(folder);
}

}  // namespace palpate::bench
