#include "server/service/protocol/hosts.h"

#include <arpa/inet.h>

#include <algorithm>
#include <cctype>

#include "render/base/utf8.h"

namespace facetless {
namespace {

std::string Lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// The host name in "name:port" or "[address]:port".
std::string NameOf(const std::string& host) {
  std::string name = Lower(host);
  if (name.starts_with('[')) {
    const std::size_t end = name.find(']');
    return end == std::string::npos ? name : name.substr(1, end - 1);
  }
  name = name.substr(0, name.find(':'));
  if (name.ends_with('.')) name.pop_back();
  return name;
}

bool IsAddress(const std::string& name) {
  in_addr four{};
  in6_addr six{};
  return inet_pton(AF_INET, name.c_str(), &four) == 1 || inet_pton(AF_INET6, name.c_str(), &six) == 1;
}

}  // namespace

std::vector<std::string> SplitList(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= list.size();) {
    const std::size_t end = std::min(list.find(',', at), list.size());
    std::string part = list.substr(at, end - at);
    const auto is_blank = [](unsigned char c) { return std::isspace(c) != 0; };
    part.erase(part.begin(), std::find_if_not(part.begin(), part.end(), is_blank));
    part.erase(std::find_if_not(part.rbegin(), part.rend(), is_blank).base(), part.end());
    if (!part.empty()) parts.push_back(part);
    at = end + 1;
  }
  return parts;
}

HostPolicy::HostPolicy(std::vector<std::string> hosts, std::vector<std::string> origins) : any_(false) {
  for (const std::string& host : hosts) hosts_.push_back(NameOf(host));
  for (const std::string& origin : origins) origins_.push_back(Lower(origin));
}

bool HostPolicy::IsKnownHost(const std::string& name) const {
  if (IsAddress(name) || name == "localhost" || name.ends_with(".localhost")) return true;
  return std::any_of(hosts_.begin(), hosts_.end(), [&](const std::string& known) {
    return known == "*" || known == name || (known.starts_with("*.") && name.ends_with(known.substr(1)));
  });
}

std::string HostPolicy::RefusalReason(const std::string& host, const std::string& origin) const {
  if (any_) return {};
  if (!host.empty() && !IsKnownHost(NameOf(host)))
    return "This service is not known as \"" + Printable(host) +
           "\". If that is one of its names, its operator adds it with --allow-host.";
  if (origin.empty()) return {};
  const std::string lower = Lower(origin);
  // Allow the origin "http://host:port" of the host that the request names, with the same port.
  const std::size_t scheme = lower.find("://");
  if (!host.empty() && scheme != std::string::npos && lower.substr(scheme + 3) == Lower(host)) return {};
  if (std::find(origins_.begin(), origins_.end(), lower) != origins_.end()) return {};
  return "Requests from pages of " + Printable(origin) +
         " are refused. If they are to be answered, the service's operator adds that origin with "
         "--allow-origin.";
}

}  // namespace facetless
