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

}  // namespace binding_detail

// Binds an option to a member of RunOptions. `member` returns a reference to that member, for const and
// non-const RunOptions. The value is parsed according to the type of the member, with the range or the
// choices of the row. The values of an enumeration correspond to the choices in their order.
template <typename Member>
OptionBinding Bound(Member member) {
  using Target = std::remove_reference_t<decltype(member(std::declval<RunOptions&>()))>;
  OptionBinding binding;
  binding.store = [member](const OptionRow& row, const nlohmann::json& json,
                           RunOptions& options) -> Result<void> {
    Target& target = member(options);
    if constexpr (std::is_same_v<Target, bool>) {
      return StoreInto(ParseBool(json, row.name), target);
    } else if constexpr (std::is_same_v<Target, int>) {
      return StoreInto(ParseInteger(json, row.name, static_cast<int>(row.low), static_cast<int>(row.high)),
                       target);
    } else if constexpr (std::is_arithmetic_v<Target> || binding_detail::IsOptional<Target>::value) {
      auto number = ParseNumber(json, row.name, row.low, row.high);
      if (!number) return number.error();
      if constexpr (std::is_integral_v<Target>) {
        target = static_cast<Target>(number.value());
      } else {
        target = number.value();
      }
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
  };
  binding.read = [member](const OptionRow& row, const RunOptions& options) -> nlohmann::json {
    const Target& target = member(options);
    if constexpr (std::is_enum_v<Target>) {
      return row.choices.at(static_cast<std::size_t>(target));
    } else if constexpr (binding_detail::IsOptional<Target>::value) {
      return target ? nlohmann::json(*target) : nlohmann::json();
    } else {
      return target;
    }
  };
  return binding;
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
OptionBinding MethodsBinding();
OptionBinding MethodBinding();
OptionBinding StartsBinding();
OptionBinding StructureBinding();
OptionBinding ShadeBinding();
OptionBinding OcclusionBinding();
OptionBinding MaterialsBinding();
OptionBinding SectionsBinding();
OptionBinding ColorBinding();
OptionBinding TurntableBinding();
OptionBinding PatternsBinding(std::vector<std::string> ArrangementRequest::*member);

}  // namespace facetless
