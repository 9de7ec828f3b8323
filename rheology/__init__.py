"""."""

if __name__ != "spinline.rheology":
    raise ImportError("import spinline.rheology, not rheology")
