"""Many scenes: sweeps, designs, stores, operating windows, the trade of error against cost, comparisons."""
