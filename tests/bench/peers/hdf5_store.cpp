#include <hdf5.h>

#include "data/trace/columns.hpp"
#include "tests/bench/data/trace_store.hpp"

namespace palpate::bench {
namespace {

using engine::TickRecord;

constexpr hsize_t kChunk = 4096;

hid_t type_of(std::string_view type) {
    if (type == "f64le") {
        return H5T_IEEE_F64LE;
    }
    if (type == "f32le") {
        return H5T_IEEE_F32LE;
    }
    if (type == "i64le") {
        return H5T_STD_I64LE;
    }
    if (type == "i32le") {
        return H5T_STD_I32LE;
    }
    return type == "i16le" ? H5T_STD_I16LE : H5T_STD_U8LE;
}

class Hdf5Store : public TraceStore {
public:
    explicit Hdf5Store(const std::string& folder)
        : name_(folder + "/rows.h5"),
          file_(H5Fcreate(name_.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)),
          row_(H5Tcreate(H5T_COMPOUND, sizeof(TickRecord))) {
        if (file_ < 0) {
            throw std::runtime_error("cannot write " + name_);
        }
        for (const data::TraceColumn& column : data::trace_columns()) {
            H5Tinsert(row_, std::string(column.name).c_str(), column.offset,
                      type_of(column.memory));
        }
    }
    ~Hdf5Store() override {
        H5Tclose(row_);
        H5Fclose(file_);
    }

    [[nodiscard]] std::string name() const override { return "HDF5, shuffle and gzip 1"; }

    void write(std::int64_t trial, std::span<const TickRecord> ticks) override {
        const hsize_t size = ticks.size();
        const hsize_t chunk = std::min(size, kChunk);
        const hid_t space = H5Screate_simple(1, &size, nullptr);
        const hid_t how = H5Pcreate(H5P_DATASET_CREATE);
        H5Pset_chunk(how, 1, &chunk);
        H5Pset_shuffle(how);
        H5Pset_deflate(how, 1);
        const hid_t set = H5Dcreate2(file_, fmt::format("t{}", trial).c_str(), row_, space,
                                     H5P_DEFAULT, how, H5P_DEFAULT);
        const herr_t code = H5Dwrite(set, row_, H5S_ALL, H5S_ALL, H5P_DEFAULT, ticks.data());
        H5Dclose(set);
        H5Pclose(how);
        H5Sclose(space);
        H5Fflush(file_, H5F_SCOPE_GLOBAL);
        if (code < 0) {
            throw std::runtime_error("cannot write " + name_);
        }
        trials_ = trial;
    }
    void finish() override { H5Fflush(file_, H5F_SCOPE_GLOBAL); }
    [[nodiscard]] std::uintmax_t bytes() const override {
        return std::filesystem::file_size(name_);
    }
    [[nodiscard]] double mean_normal_force(std::int64_t trial) override {
        Sum sum;
        add(trial, "rendered_normal_n", sum);
        return sum.value / static_cast<double>(sum.n);
    }
    [[nodiscard]] double mean_command_x() override {
        Sum sum;
        for (std::int64_t trial = 1; trial <= trials_; ++trial) {
            add(trial, "commanded_x_n", sum);
        }
        return sum.value / static_cast<double>(sum.n);
    }

private:
    struct Sum {
        double value = 0.0;
        std::size_t n = 0;
    };
    void add(std::int64_t trial, const char* column, Sum& sum) {
        const hid_t set = H5Dopen2(file_, fmt::format("t{}", trial).c_str(), H5P_DEFAULT);
        const hid_t space = H5Dget_space(set);
        std::vector<double> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
        const hid_t one = H5Tcreate(H5T_COMPOUND, sizeof(double));
        H5Tinsert(one, column, 0, H5T_NATIVE_DOUBLE);
        H5Dread(set, one, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
        for (const double value : values) {
            sum.value += value;
        }
        sum.n += values.size();
        H5Tclose(one);
        H5Sclose(space);
        H5Dclose(set);
    }

    std::string name_;
    hid_t file_;
    hid_t row_;
    std::int64_t trials_ = 0;
};

}  // namespace

std::unique_ptr<TraceStore> hdf5_store(const std::string& folder) {
    return std::make_unique<Hdf5Store>(folder);
}

}  // namespace palpate::bench
