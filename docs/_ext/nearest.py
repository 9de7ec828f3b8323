"""References of the docstrings to the nearest thing of that name: Sphinx takes any, and warns where there are several.

A bare name is looked for in the module that says it, then where that module has it from, then in the documented names, the
longest common path first. Words in the type of a parameter (``shape (n,)``) are no references.
"""

import sys

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.transforms.post_transforms import SphinxPostTransform


class Nearest(SphinxPostTransform):
    """Before references are resolved, which is at a priority of 10."""

    default_priority = 5

    def run(self, **_):
        """Rewrite what has several targets; take out what has none that is meant."""
        for node in list(self.document.findall(pending_xref)):
            target = node.get("reftarget", "")
            if node.get("refdomain") != "py" or not target.isidentifier():
                continue
            lower = target.islower()
            if lower and node["reftype"] == "class":
                node.replace_self(list(node.children) or nodes.Text(target))
                continue
            names = [name for name in self.env.domaindata["py"]["objects"] if name.endswith(f".{target}")]
            if len(names) < 2:
                continue
            module = node.get("py:module") or ""
            best = self.best(target, names, module, node.get("py:class") or "")
            if lower and not best.startswith(module):
                node.replace_self(list(node.children))
            else:
                node["reftarget"], node["refspecific"] = best, False

    @staticmethod
    def best(target, names, module, within):
        """Of several full names, the one that is meant in a module."""
        for own in (f"{module}.{within}.{target}", f"{module}.{target}"):
            if own in names:
                return own
        thing = getattr(sys.modules.get(module), target, None)
        home = f"{getattr(thing, '__module__', '')}.{target}"
        if home in names:
            return home
        path = module.split(".")

        def together(name):
            """How many parts of the path are shared."""
            parts = list(zip(name.split("."), path, strict=False))
            return next((i for i, (a, b) in enumerate(parts) if a != b), len(parts))

        return max(names, key=lambda name: (together(name), -len(name)))


def setup(app):
    """Register the transform."""
    app.add_post_transform(Nearest)
    return {"parallel_read_safe": True}
