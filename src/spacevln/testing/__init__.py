"""Public test doubles and conformance suites: what a third party needs to test an own part."""
