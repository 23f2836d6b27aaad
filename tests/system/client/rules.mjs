// The linter's rules for openapi.json: all that Redocly recommends, with warnings as errors. Each rule that is off has a
// reason.
export const rules = {
  extends: ["recommended-strict"],
  rules: {
    // Requests for a page, a health check or this document contain nothing that could be wrong. Errors of the transport,
    // which any request may have, are described once, in info.description.
    "operation-4xx-response": "off",
  },
};
