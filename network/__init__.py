"""."""

if __name__ != "spinline.network":
    raise ImportError("import spinline.network, not network")
