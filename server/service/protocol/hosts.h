// The hosts and origins for which a service answers requests. This policy prevents a page of another site
// from reading a service on its visitor's machine.
//
//     const HostPolicy policy({"cad.example.org"}, {});
//     const std::string why = policy.RefusalReason(request.Header("host"), request.Header("origin"));
//     if (!why.empty()) return Problem(403, "host-not-allowed", "Host or origin not allowed", why);
//
//  1. Such a page can let its own host name resolve to this machine (DNS rebinding). The browser then
//     considers its requests same-origin, and they name the page's host. A request must therefore name a host
//     by which this service is known: a numeric address, localhost, a name below localhost, or a name from
//     the list. A request without a Host header is answered, because browsers always send one.
//  2. If a request has an Origin header, it must be the origin of the host that the request names, or one
//     from the list.
//  3. Host names are compared without regard to case, a final dot or the port. Origins are compared with
//     their ports.
#pragma once

#include <string>
#include <vector>

namespace facetless {

class HostPolicy {
 public:
  // Allows all hosts and origins.
  HostPolicy() = default;
  // `hosts` are names such as "cad.example.org", "*.example.org" for all names below example.org, or "*" for
  // any name. `origins` are texts such as "https://cad.example.org:8443".
  HostPolicy(std::vector<std::string> hosts, std::vector<std::string> origins);

  // The reason why a request with these headers is refused, as a sentence that names the option to change;
  // empty if the request is allowed.
  std::string RefusalReason(const std::string& host, const std::string& origin) const;

 private:
  bool IsKnownHost(const std::string& name) const;

  bool any_ = true;
  std::vector<std::string> hosts_, origins_;
};

// The entries of a list "a, b", without surrounding blanks and without empty entries.
std::vector<std::string> SplitList(const std::string& list);

}  // namespace facetless
