// trendid for C++17: the functions of trendid.h as members of values. Header only, no exceptions, no heap.
//
// A value may be copied and assigned, as the objects of C may. Errors are the codes of C; `detail` says which setting was
// refused. MIT or Apache-2.0.
#ifndef TRENDID_HPP
#define TRENDID_HPP

#include <array>
#include <cstddef>
#include <cstdint>

#include "trendid.h"

namespace trendid {

using error = trendid_error;
using detail = trendid_detail;
using settings = trendid_settings;
using loop_settings = trendid_loop_settings;

/// A value, or the code that says why there is none.
template <class T>
struct result {
    error code = TRENDID_ERROR_OK;
    T value{};

    explicit operator bool() const noexcept { return code == TRENDID_ERROR_OK; }
};

/// One sentence on a code.
inline const char *text(error code) noexcept { return trendid_error_text(code); }

/// The defaults for a sample time (s), a rough bandwidth (rad/s) and the typical sizes of command and position.
inline settings defaults(float sample_time, float bandwidth, float input_range, float output_range) noexcept {
    settings made{};
    static_cast<void>(trendid_settings_init(&made, sample_time, bandwidth, input_range, output_range));
    return made;
}

/// The defaults for an axis of which sample time (s), travel, scale and reference of the sensor are known.
inline loop_settings defaults(float sample_time, float travel_min, float travel_max, float units_per_count,
                              std::int32_t reference_code) noexcept {
    loop_settings made{};
    static_cast<void>(trendid_loop_settings_init(&made, sample_time, travel_min, travel_max, units_per_count,
                                                 reference_code));
    return made;
}

namespace internal {

/// Sizes and beginning of each kind of memory.
template <class Memory>
struct kind;

#define TRENDID_KIND(name, degree, count, given)                                                                    \
    template <>                                                                                                     \
    struct kind<trendid_##name> {                                                                                   \
        static constexpr std::size_t order = degree;                                                                \
        static constexpr std::size_t parameters = count;                                                            \
        static constexpr std::size_t inputs = given;                                                                \
        static error init(trendid_##name *memory, const settings &of, trendid_identifier **handle, detail *why) {   \
            return trendid_##name##_init(memory, &of, handle, why);                                                 \
        }                                                                                                           \
    };
TRENDID_KIND(servo2, 2, 4, 1)
TRENDID_KIND(servo3, 3, 5, 1)
TRENDID_KIND(valve2, 2, 5, 1)
TRENDID_KIND(valve3, 3, 6, 1)
TRENDID_KIND(coulomb2, 2, 5, 2)
TRENDID_KIND(coulomb3, 3, 6, 2)
TRENDID_KIND(valve_coulomb2, 2, 6, 2)
TRENDID_KIND(valve_coulomb3, 3, 7, 2)
TRENDID_KIND(instrumented2, 2, 4, 1)
TRENDID_KIND(instrumented3, 3, 5, 1)
#undef TRENDID_KIND

}  // namespace internal

/// An identifier in memory of a kind; not usable before `init`.
template <class Memory>
class identifier {
    using kind = internal::kind<Memory>;

  public:
    static constexpr std::size_t order = kind::order;
    static constexpr std::size_t parameters = kind::parameters;
    static constexpr std::size_t inputs = kind::inputs;
    using vector = std::array<float, parameters>;

    error init(const settings &of, detail *why = nullptr) noexcept {
        trendid_identifier *handle = nullptr;
        return kind::init(&memory_, of, &handle, why);
    }

    /// One sample of a kind with one input.
    result<trendid_outcome> update(float u, float y) noexcept {
        result<trendid_outcome> made;
        made.code = trendid_identifier_update(handle(), u, y, &made.value);
        return made;
    }

    /// One sample with all inputs.
    result<trendid_outcome> update(const std::array<float, inputs> &u, float y) noexcept {
        result<trendid_outcome> made;
        made.code = trendid_identifier_update_inputs(handle(), u.data(), u.size(), y, &made.value);
        return made;
    }

    result<vector> theta() const noexcept {
        result<vector> made;
        made.code = trendid_identifier_theta(handle(), made.value.data(), parameters);
        return made;
    }

    result<trendid_estimate> estimate() const noexcept {
        result<trendid_estimate> made;
        made.code = trendid_identifier_estimate(handle(), &made.value);
        return made;
    }

    result<std::array<float, parameters * parameters>> covariance() const noexcept {
        result<std::array<float, parameters * parameters>> made;
        made.code = trendid_identifier_covariance(handle(), made.value.data(), made.value.size());
        return made;
    }

    result<std::array<trendid_parameter, parameters>> meaning() const noexcept {
        result<std::array<trendid_parameter, parameters>> made;
        made.code = trendid_identifier_parameters(handle(), made.value.data(), parameters);
        return made;
    }

    /// The poles, integrators first.
    result<std::array<trendid_pole, order>> poles() const noexcept {
        result<std::array<trendid_pole, order>> made;
        made.code = trendid_identifier_poles(handle(), made.value.data(), order);
        return made;
    }

    result<trendid_status> status() const noexcept {
        result<trendid_status> made;
        made.code = trendid_identifier_status(handle(), &made.value);
        return made;
    }

    error skip(std::uint32_t samples) noexcept { return trendid_identifier_skip(handle(), samples); }
    error reset() noexcept { return trendid_identifier_reset(handle()); }
    error restart_trends() noexcept { return trendid_identifier_restart_trends(handle()); }
    error set_nominal() noexcept { return trendid_identifier_set_nominal(handle()); }
    error adapt(bool on) noexcept { return trendid_identifier_adapt(handle(), on); }
    error retune(float omega0, detail *why = nullptr) noexcept {
        return trendid_identifier_retune(handle(), omega0, why);
    }
    error warm_start(const vector &theta, const vector &std, detail *why = nullptr) noexcept {
        return trendid_identifier_warm_start(handle(), theta.data(), std.data(), parameters, why);
    }

    /// The handle for the functions of C; it points into this value.
    trendid_identifier *handle() noexcept { return reinterpret_cast<trendid_identifier *>(&memory_); }
    const trendid_identifier *handle() const noexcept {
        return reinterpret_cast<const trendid_identifier *>(&memory_);
    }

    /// The memory, for `delay_bank::chosen`.
    Memory *memory() noexcept { return &memory_; }

  private:
    Memory memory_{};
};

using servo2 = identifier<trendid_servo2>;
using servo3 = identifier<trendid_servo3>;
using valve2 = identifier<trendid_valve2>;
using valve3 = identifier<trendid_valve3>;
using coulomb2 = identifier<trendid_coulomb2>;
using coulomb3 = identifier<trendid_coulomb3>;
using valve_coulomb2 = identifier<trendid_valve_coulomb2>;
using valve_coulomb3 = identifier<trendid_valve_coulomb3>;
using instrumented2 = identifier<trendid_instrumented2>;
using instrumented3 = identifier<trendid_instrumented3>;

/// The mean sign of the velocity from sample to sample, for an input of the hold `TRENDID_HOLD_MEAN`; not usable before `init`.
class friction {
  public:
    /// Velocities within `rest` of zero are zero.
    error init(float rest, detail *why = nullptr) noexcept { return trendid_friction_init(&memory_, rest, why); }

    result<float> update(float velocity) noexcept {
        result<float> made;
        made.code = trendid_friction_update(&memory_, velocity, &made.value);
        return made;
    }

  private:
    trendid_friction memory_{};
};

/// The delay of a drive; not usable before `init`.
class delay_bank {
  public:
    struct choice {
        std::uint32_t delay;
        float margin;
    };

    error init(const settings &of, detail *why = nullptr) noexcept {
        return trendid_delay_bank_init(&memory_, &of, why);
    }

    result<trendid_outcome> update(float u, float y) noexcept {
        result<trendid_outcome> made;
        made.code = trendid_delay_bank_update(&memory_, u, y, &made.value);
        return made;
    }

    result<choice> best() const noexcept {
        result<choice> made;
        made.code = trendid_delay_bank_best(&memory_, &made.value.delay, &made.value.margin);
        return made;
    }

    /// The delay between the samples.
    result<float> refined() const noexcept {
        result<float> made;
        made.code = trendid_delay_bank_refined(&memory_, &made.value);
        return made;
    }

    result<servo3> chosen() const noexcept {
        result<servo3> made;
        trendid_identifier *handle = nullptr;
        made.code = trendid_delay_bank_chosen(&memory_, made.value.memory(), &handle);
        return made;
    }

  private:
    trendid_delay_bank memory_{};
};

/// The adaptive position loop; not usable before `init`.
class loop {
  public:
    using record = std::array<std::uint8_t, TRENDID_RECORD_BYTES>;

    error init(const loop_settings &of, detail *why = nullptr) noexcept {
        return trendid_loop_init(&memory_, &of, why);
    }

    /// One sample: the code of the sensor in, the command for the valve in the report.
    result<trendid_report> update(std::int32_t code) noexcept {
        result<trendid_report> made;
        made.code = trendid_loop_update(&memory_, code, &made.value);
        return made;
    }

    /// One sample whose reading failed.
    result<trendid_report> update_blind() noexcept {
        result<trendid_report> made;
        made.code = trendid_loop_update_blind(&memory_, &made.value);
        return made;
    }

    error valve_fault() noexcept { return trendid_loop_valve_fault(&memory_); }
    error commission() noexcept { return trendid_loop_commission(&memory_); }
    error abort() noexcept { return trendid_loop_abort(&memory_); }
    error move_to(float target, detail *why = nullptr) noexcept {
        return trendid_loop_move_to(&memory_, target, why);
    }
    error oscillate(float amplitude, float frequency, detail *why = nullptr) noexcept {
        return trendid_loop_oscillate(&memory_, amplitude, frequency, why);
    }
    error install(const trendid_model &model, detail *why = nullptr) noexcept {
        return trendid_loop_install(&memory_, &model, why);
    }

    /// Delay, margins, and how well the model is known.
    result<trendid_quality> quality() const noexcept {
        result<trendid_quality> made;
        made.code = trendid_loop_quality(&memory_, &made.value);
        return made;
    }

    result<trendid_model> model() const noexcept {
        result<trendid_model> made;
        made.code = trendid_loop_model(&memory_, &made.value);
        return made;
    }

    result<record> store(std::uint32_t plant, std::uint32_t sequence) const noexcept {
        result<record> made;
        made.code = trendid_loop_store(&memory_, plant, sequence, made.value.data(), made.value.size());
        return made;
    }

    /// Control with a stored model; gives the number of the record.
    result<std::uint32_t> load(std::uint32_t plant, const record &bytes, detail *why = nullptr) noexcept {
        result<std::uint32_t> made;
        made.code = trendid_loop_load(&memory_, plant, bytes.data(), bytes.size(), &made.value, why);
        return made;
    }

  private:
    trendid_loop memory_{};
};

}  // namespace trendid

#endif  // TRENDID_HPP
