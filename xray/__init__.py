"""."""

if __name__ != "spinline.xray":
    raise ImportError("import spinline.xray, not xray")
