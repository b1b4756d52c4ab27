#include <istream>
#include <ostream>

#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

constexpr std::array kKinds{Kind::floor, Kind::global, Kind::tracker, Kind::mesh, Kind::peer};
constexpr const char* kHead =
    "machine,object,path,method,kind,ratio,ratio_low,ratio_high,instructions,rounds,thrown_rounds,"
    "warm_ns,tick_p50_ns,tick_p99_ns,tick_p999_ns,cold_p50_ns,cold_p99_ns,distance_error_p50_m,"
    "distance_error_p99_m,distance_error_max_m,foot_error_p99_m,miss_share";
constexpr std::size_t kTexts = 5;
constexpr std::size_t kErrors = 5;  ///< the last numbers, empty for Kind::floor

/// The numbers of a row, in the order of the head.
std::array<double*, 17> numbers_of(Row& row) {
    Timing& t = row.time;
    Errors& e = row.error;
    return {&t.ratio.value, &t.ratio.low, &t.ratio.high,   &t.instructions, &t.rounds,
            &t.thrown,      &t.warm,      &t.p50,          &t.p99,          &t.p999,
            &t.cold_p50,    &t.cold_p99,  &e.distance_p50, &e.distance_p99, &e.distance_max,
            &e.foot_p99,    &e.misses};
}

/// The fields of a line, without their quotation marks.
std::vector<std::string> fields_of(const std::string& line) {
    std::vector<std::string> fields(1);
    bool quoted = false;
    for (const char c : line) {
        if (c == '"') {
            quoted = !quoted;
        } else if (c == ',' && !quoted) {
            fields.emplace_back();
        } else {
            fields.back() += c;
        }
    }
    return fields;
}

}  // namespace

const char* name_of(Kind kind) {
    switch (kind) {
        case Kind::floor:
            return "floor";
        case Kind::global:
            return "global";
        case Kind::tracker:
            return "tracker";
        case Kind::mesh:
            return "mesh";
        default:
            return "peer";
    }
}

void write_csv(std::ostream& out, std::vector<Row> rows) {
    out << kHead << '\n';
    for (Row& row : rows) {
        out << fmt::format("\"{}\",\"{}\",\"{}\",\"{}\",{}", row.machine, row.object, row.path,
                           row.method, name_of(row.kind));
        const auto numbers = numbers_of(row);
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const bool none = row.kind == Kind::floor && i + kErrors >= numbers.size();
            out << (none ? "," : fmt::format(",{:.7g}", *numbers[i]));
        }
        out << '\n';
    }
}

std::vector<Row> read_csv(std::istream& in) {
    std::string line;
    if (!std::getline(in, line) || line != kHead) {
        throw std::runtime_error("this is no table of bench contact: its first line differs");
    }
    std::vector<Row> rows;
    while (std::getline(in, line)) {
        const std::vector<std::string> f = fields_of(line);
        Row& row = rows.emplace_back();
        const auto numbers = numbers_of(row);
        if (f.size() != kTexts + numbers.size()) {
            throw std::runtime_error(
                fmt::format("a line has not {} fields: {}", kTexts + numbers.size(), line));
        }
        row.machine = f[0];
        row.object = f[1];
        row.path = f[2];
        row.method = f[3];
        for (const Kind kind : kKinds) {
            row.kind = f[4] == name_of(kind) ? kind : row.kind;
        }
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const std::string& text = f[kTexts + i];
            *numbers[i] = text.empty() ? 0.0 : std::stod(text);
        }
    }
    return rows;
}

}  // namespace palpate::bench
