// The bindings of the option table: they store the values of options in RunOptions, and read them back.
#pragma once

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "server/options/option_table.h"
#include "server/options/option_values.h"
#include "server/options/options.h"

namespace facetless {

namespace binding_detail {

template <typename T>
struct IsOptional : std::false_type {};
template <typename T>
struct IsOptional<std::optional<T>> : std::true_type {};

// Parses a value according to the type of the target.
template <typename Target>
Result<void> Store(const OptionRow& row, const nlohmann::json& json, Target& target) {
  if constexpr (IsOptional<Target>::value) {
    typename Target::value_type value{};
    if (auto stored = Store(row, json, value); !stored) return stored;
    target = value;
    return {};
  } else if constexpr (std::is_same_v<Target, bool>) {
    return StoreInto(ParseBool(json, row.name), target);
  } else if constexpr (std::is_same_v<Target, int>) {
    return StoreInto(ParseInteger(json, row.name, static_cast<int>(row.low), static_cast<int>(row.high)),
                     target);
  } else if constexpr (std::is_arithmetic_v<Target>) {
    auto number = ParseNumber(json, row.name, row.low, row.high);
    if (!number) return number.error();
    target = static_cast<Target>(number.value());
    return {};
  } else if constexpr (std::is_same_v<Target, std::string>) {
    if (row.choices.empty()) return StoreInto(ParseText(json, row.name), target);
    auto index = ParseWord(json, row.name, row.choices);
    if (!index) return index.error();
    target = row.choices[static_cast<std::size_t>(index.value())];
    return {};
  } else if constexpr (std::is_enum_v<Target>) {
    auto index = ParseWord(json, row.name, row.choices);
    if (!index) return index.error();
    target = static_cast<Target>(index.value());
    return {};
  } else {
    static_assert(std::is_same_v<Target, std::vector<double>>, "no option is stored in such a member");
    return StoreInto(ParseNumbers(json, row.name, row.low, row.high), target);
  }
}

template <typename Target>
nlohmann::json Read(const OptionRow& row, const Target& target) {
  if constexpr (IsOptional<Target>::value) {
    return target ? Read(row, *target) : nlohmann::json();
  } else if constexpr (std::is_enum_v<Target>) {
    return row.choices.at(static_cast<std::size_t>(target));
  } else {
    return target;
  }
}

}  // namespace binding_detail

// Binds an option to a member of RunOptions. `member` returns a reference to that member, for const and
// non-const RunOptions. The value is parsed according to the type of the member, with the range or the
// choices of the row. The values of an enumeration correspond to the choices in their order.
template <typename Member>
OptionBinding Bound(Member member) {
  return {[member](const OptionRow& row, const nlohmann::json& json, RunOptions& options) {
            return binding_detail::Store(row, json, member(options));
          },
          [member](const OptionRow& row, const RunOptions& options) {
            return binding_detail::Read(row, member(options));
          }};
}

// The bindings of options with special forms.
OptionBinding ViewsBinding();
OptionBinding CamerasBinding();
OptionBinding SizeBinding();
OptionBinding SamplesBinding();
OptionBinding ViewMemoryBinding();  // the option is in megabytes, the member in bytes
OptionBinding UnitBinding();
OptionBinding AovsBinding();
OptionBinding WithBinding();
OptionBinding VoxelsBesideBinding();
OptionBinding MethodsBinding();
OptionBinding MethodBinding();
OptionBinding StructureBinding();
OptionBinding ShadeBinding();
OptionBinding OcclusionBinding();
OptionBinding MaterialsBinding();
OptionBinding SectionsBinding();
OptionBinding PointLightsBinding();
OptionBinding ColorBinding();
OptionBinding TurntableBinding();
OptionBinding PatternsBinding(std::vector<std::string> ArrangementRequest::*member);

}  // namespace facetless
