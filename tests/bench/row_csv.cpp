#include <array>
#include <istream>
#include <ostream>
#include <stdexcept>

#include <fmt/format.h>

#include "tests/bench/report.hpp"

namespace palpate::bench {
namespace {

constexpr std::array kKinds{Kind::floor, Kind::global, Kind::tracker, Kind::mesh, Kind::peer};
constexpr const char* kHead =
    "machine,object,path,method,kind,warm_ns,tick_p50_ns,tick_p99_ns,tick_p999_ns,cold_p50_ns,"
    "cold_p99_ns,distance_error_p50_m,distance_error_p99_m,distance_error_max_m,"
    "foot_error_p99_m,miss_share";
constexpr std::size_t kFields = 16;

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

double number(const std::string& field) {
    return field.empty() ? 0.0 : std::stod(field);
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

void write_csv(std::ostream& out, const std::vector<Row>& rows) {
    out << kHead << '\n';
    for (const Row& row : rows) {
        out << fmt::format(
            "\"{}\",\"{}\",\"{}\",\"{}\",{},{:.2f},{:.1f},{:.1f},{:.1f},{:.1f},{:.1f}", row.machine,
            row.object, row.path, row.method, name_of(row.kind), row.time.warm, row.time.p50,
            row.time.p99, row.time.p999, row.time.cold_p50, row.time.cold_p99);
        if (row.kind == Kind::floor) {
            out << ",,,,,\n";
        } else {
            out << fmt::format(",{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}\n", row.error.distance_p50,
                               row.error.distance_p99, row.error.distance_max, row.error.foot_p99,
                               row.error.misses);
        }
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
        if (f.size() != kFields) {
            throw std::runtime_error("a line has not 16 fields: " + line);
        }
        Row& row = rows.emplace_back();
        row.machine = f[0];
        row.object = f[1];
        row.path = f[2];
        row.method = f[3];
        for (const Kind kind : kKinds) {
            row.kind = f[4] == name_of(kind) ? kind : row.kind;
        }
        row.time.warm = number(f[5]);
        row.time.p50 = number(f[6]);
        row.time.p99 = number(f[7]);
        row.time.p999 = number(f[8]);
        row.time.cold_p50 = number(f[9]);
        row.time.cold_p99 = number(f[10]);
        row.error.distance_p50 = number(f[11]);
        row.error.distance_p99 = number(f[12]);
        row.error.distance_max = number(f[13]);
        row.error.foot_p99 = number(f[14]);
        row.error.misses = number(f[15]);
    }
    return rows;
}

}  // namespace palpate::bench
